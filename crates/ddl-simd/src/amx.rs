//! The matrix unit AMX of x86-64 processors under Linux. Like `x86.rs`, this is unsafe code behind safe methods.
//!
//! The unit has eight tiles of sixteen rows of 64 bytes. The compiler does not use them, so a kernel may.

#![allow(unsafe_code, reason = "instructions that not every processor has")]
#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]
#![allow(clippy::wildcard_imports, reason = "the names of instructions show their origin")]

use std::arch::asm;
use std::arch::x86_64::*;
use std::sync::OnceLock;

use crate::block::{BLOCK, Block, Panel};
use crate::matrix::{LeftFactor, Line, MatrixKernel, MatrixUnit, Pieces, RightFactor, Start};
use crate::register::Register;
use crate::sixteen::Sixteen;
use crate::x86::Avx512;

/// The proof that the processor has AMX for bf16 and AVX-512 BW, beside F and DQ, and that the kernel allows the
/// process to use the tiles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Amx(Avx512);

/// Shapes of the tiles, as the instruction that loads them reads them.
#[repr(C, align(64))]
struct TileShapes {
    palette: u8,
    start_row: u8,
    reserved: [u8; 14],
    row_bytes: [u16; 16],
    rows: [u8; 16],
}

const SHAPES: TileShapes = TileShapes {
    palette: 1,
    start_row: 0,
    reserved: [0; 14],
    row_bytes: [64, 64, 64, 64, 64, 64, 64, 64, 0, 0, 0, 0, 0, 0, 0, 0],
    rows: [16, 16, 16, 16, 16, 16, 16, 16, 0, 0, 0, 0, 0, 0, 0, 0],
};

impl Amx {
    pub(crate) fn detect() -> Option<Self> {
        static ALLOWED: OnceLock<bool> = OnceLock::new();
        let avx512 = Avx512::detect().filter(|_| is_x86_feature_detected!("avx512bw"))?;
        let allowed = *ALLOWED.get_or_init(|| has_tiles() && are_tiles_allowed());
        allowed.then_some(Self(avx512))
    }

    pub(crate) fn avx512(self) -> Avx512 {
        self.0
    }

    #[inline]
    pub(crate) fn run<K: MatrixKernel>(self, kernel: K) {
        #[target_feature(enable = "avx2,fma,avx512f,avx512dq,avx512bw")]
        fn compiled<K: MatrixKernel>(unit: Amx, kernel: K) {
            // SAFETY: `unit` is the proof that the processor has the instructions and that they are allowed. The
            // constant has the layout that the first one reads.
            unsafe { asm!("ldtilecfg [{}]", in(reg) std::ptr::from_ref(&SHAPES), options(nostack, readonly)) };
            kernel.run(unit);
            // SAFETY: as above. Tiles that are not in use are not saved when the thread is interrupted.
            unsafe { asm!("tilerelease", options(nostack, nomem)) };
        }
        // SAFETY: `self` is the proof that the processor has the instructions.
        unsafe { compiled(self, kernel) }
    }
}

/// Whether the processor has AMX for bf16 numbers.
fn has_tiles() -> bool {
    let leaves = __cpuid(0).eax;
    let [bf16, tiles] = [1 << 22, 1 << 24];
    leaves >= 7 && __cpuid_count(7, 0).edx & (bf16 | tiles) == bf16 | tiles
}

/// Asks Linux for the permission to use tiles, which a process must have.
fn are_tiles_allowed() -> bool {
    const ARCH_PRCTL: usize = 158;
    const REQUEST_PERMISSION: usize = 0x1023;
    const TILE_DATA: usize = 18;
    let result: usize;
    // SAFETY: the call has two numbers as arguments, changes no memory of the process, and overwrites the registers
    // named here.
    unsafe {
        asm!(
            "syscall",
            inlateout("rax") ARCH_PRCTL => result,
            in("rdi") REQUEST_PERMISSION,
            in("rsi") TILE_DATA,
            lateout("rcx") _,
            lateout("r11") _,
            options(nostack),
        );
    }
    result == 0
}

impl Amx {
    /// Half a unit in the last place of a bf16 number, added to the representation of `a`: the upper half is then `a`,
    /// rounded.
    #[inline(always)]
    fn rounded(a: __m512) -> __m512 {
        // SAFETY: called only by methods of `Amx`, whose value is the proof that the processor has the instructions.
        unsafe { _mm512_castsi512_ps(_mm512_add_epi32(_mm512_castps_si512(a), _mm512_set1_epi32(0x8000))) }
    }

    /// `a` minus the upper half of `piece`.
    #[inline(always)]
    fn rest(a: __m512, piece: __m512) -> __m512 {
        // SAFETY: as in `rounded`.
        unsafe {
            let upper = _mm512_and_si512(
                _mm512_castps_si512(piece),
                _mm512_set1_epi32(0xffff_0000_u32.cast_signed()),
            );
            _mm512_sub_ps(a, _mm512_castsi512_ps(upper))
        }
    }
}

/// Bytes of a row of a panel.
const ROW: usize = size_of::<Block>();

/// Numbers of the 16-bit halves of two registers.
#[repr(C, align(64))]
struct Order([i16; BLOCK]);

/// The upper halves of the first register, then those of the second.
const SEQUENCE: Order = {
    let mut order = [0; BLOCK];
    let mut i = 0;
    while i < BLOCK {
        order[i] = 2 * i as i16 + 1;
        i += 1;
    }
    Order(order)
};

/// The upper halves of both registers in turns.
const PAIRS: Order = {
    let mut order = [0; BLOCK];
    let mut i = 0;
    while i < BLOCK {
        order[i] = (i as i16 / 2) * 2 + 1 + (i as i16 % 2) * 32;
        i += 1;
    }
    Order(order)
};

impl Order {
    #[inline(always)]
    fn store(&self, _proof: Amx, [a]: [__m512; 1], [b]: [__m512; 1], into: &mut Line) {
        // SAFETY: the argument is the proof that the processor has the instructions; `Order` and `Line` have the size
        // and the alignment of a register.
        unsafe {
            let order = _mm512_load_si512((&raw const self.0).cast());
            let [a, b] = [_mm512_castps_si512(a), _mm512_castps_si512(b)];
            _mm512_store_si512((&raw mut into.0).cast(), _mm512_permutex2var_epi16(a, order, b));
        }
    }
}

impl MatrixUnit for Amx {
    type Simd = Sixteen<Avx512, 1>;

    #[inline(always)]
    fn simd(self) -> Self::Simd {
        self.0.sixteen()
    }

    #[inline(always)]
    fn pieces(self, [a]: [__m512; 1]) -> Pieces<Self> {
        let first = Self::rounded(a);
        let rest = Self::rest(a, first);
        let second = Self::rounded(rest);
        [[first], [second], [Self::rest(rest, second)]]
    }

    #[inline(always)]
    fn in_sequence(self, a: [__m512; 1], b: [__m512; 1], into: &mut Line) {
        SEQUENCE.store(self, a, b, into);
    }

    #[inline(always)]
    fn in_pairs(self, a: [__m512; 1], b: [__m512; 1], into: &mut Line) {
        PAIRS.store(self, a, b, into);
    }

    /// Tiles 0 to 3 are the quarters of the sum.
    #[inline(always)]
    fn start(self, start: Start<'_>) {
        let (from, step) = match start {
            Start::Row(row) => (std::ptr::from_ref(row), 0),
            Start::Panel(panel) => (panel.as_ptr(), ROW),
        };
        // SAFETY: `self` is the proof that the processor has the instructions and that they are allowed, and exists only
        // where `run` has set the shapes. Sixteen rows of 64 bytes each are read from four places in `start`.
        unsafe {
            asm!(
                "tileloadd tmm0, [{from} + 1*{step}]",
                "tileloadd tmm1, [{from} + 1*{step} + 64]",
                "tileloadd tmm2, [{lower_from} + {step}]",
                "tileloadd tmm3, [{lower_from} + {step} + 64]",
                from = in(reg) from,
                lower_from = in(reg) from.byte_add(16 * step),
                step = in(reg) step,
                options(nostack, readonly),
            );
        }
    }

    /// Tiles 4 and 5 are the halves of the rows of `a`, 6 and 7 those of the columns of `b`. The smallest products come
    /// first.
    #[inline(always)]
    fn add_product(self, a: &LeftFactor, b: &RightFactor) {
        // SAFETY: as in `start`. Sixteen rows of 64 bytes each are read from six places in `a` and in `b`.
        unsafe {
            asm!(
                // First pieces of a, third of b.
                "tileloadd tmm4, [{a} + 1*{line}]",
                "tileloadd tmm6, [{b} + 1*{line} + 4096]",
                "tdpbf16ps tmm0, tmm4, tmm6",
                "tileloadd tmm7, [{b} + 1*{line} + 5120]",
                "tdpbf16ps tmm1, tmm4, tmm7",
                "tileloadd tmm5, [{a} + 1*{line} + 1024]",
                "tdpbf16ps tmm2, tmm5, tmm6",
                "tdpbf16ps tmm3, tmm5, tmm7",
                // Third of a, first of b.
                "tileloadd tmm4, [{a} + 1*{line} + 4096]",
                "tileloadd tmm6, [{b} + 1*{line}]",
                "tdpbf16ps tmm0, tmm4, tmm6",
                "tileloadd tmm7, [{b} + 1*{line} + 1024]",
                "tdpbf16ps tmm1, tmm4, tmm7",
                "tileloadd tmm5, [{a} + 1*{line} + 5120]",
                "tdpbf16ps tmm2, tmm5, tmm6",
                "tdpbf16ps tmm3, tmm5, tmm7",
                // Second of both.
                "tileloadd tmm4, [{a} + 1*{line} + 2048]",
                "tileloadd tmm6, [{b} + 1*{line} + 2048]",
                "tdpbf16ps tmm0, tmm4, tmm6",
                "tileloadd tmm7, [{b} + 1*{line} + 3072]",
                "tdpbf16ps tmm1, tmm4, tmm7",
                "tileloadd tmm5, [{a} + 1*{line} + 3072]",
                "tdpbf16ps tmm2, tmm5, tmm6",
                "tdpbf16ps tmm3, tmm5, tmm7",
                // Second of a, first of b.
                "tileloadd tmm6, [{b} + 1*{line}]",
                "tdpbf16ps tmm0, tmm4, tmm6",
                "tileloadd tmm7, [{b} + 1*{line} + 1024]",
                "tdpbf16ps tmm1, tmm4, tmm7",
                "tdpbf16ps tmm2, tmm5, tmm6",
                "tdpbf16ps tmm3, tmm5, tmm7",
                // First of a, second of b.
                "tileloadd tmm4, [{a} + 1*{line}]",
                "tileloadd tmm6, [{b} + 1*{line} + 2048]",
                "tdpbf16ps tmm0, tmm4, tmm6",
                "tileloadd tmm7, [{b} + 1*{line} + 3072]",
                "tdpbf16ps tmm1, tmm4, tmm7",
                "tileloadd tmm5, [{a} + 1*{line} + 1024]",
                "tdpbf16ps tmm2, tmm5, tmm6",
                "tdpbf16ps tmm3, tmm5, tmm7",
                // First of both.
                "tileloadd tmm6, [{b} + 1*{line}]",
                "tdpbf16ps tmm0, tmm4, tmm6",
                "tileloadd tmm7, [{b} + 1*{line} + 1024]",
                "tdpbf16ps tmm1, tmm4, tmm7",
                "tdpbf16ps tmm2, tmm5, tmm6",
                "tdpbf16ps tmm3, tmm5, tmm7",
                a = in(reg) a,
                b = in(reg) b,
                line = in(reg) size_of::<Line>(),
                options(nostack, readonly),
            );
        }
    }

    #[inline(always)]
    fn store(self, sum: &mut Panel) {
        // SAFETY: as in `start`. Sixteen rows of 64 bytes each are written to four places in `sum`.
        unsafe {
            asm!(
                "tilestored [{sum} + 1*{row}], tmm0",
                "tilestored [{sum} + 1*{row} + 64], tmm1",
                "tilestored [{sum} + 1*{row} + 2048], tmm2",
                "tilestored [{sum} + 1*{row} + 2112], tmm3",
                sum = in(reg) sum,
                row = in(reg) ROW,
                options(nostack),
            );
        }
    }
}
