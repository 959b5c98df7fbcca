//! Work of a card that is recorded once and replayed: CUDA graphs of libtorch, which `tch` does not bind.
//!
//! A training step is thousands of small kernels, and launching each takes the processor longer than the card needs for
//! it. A recorded step is launched as a whole.
#![allow(unsafe_code, reason = "calls functions of libtorch by their names")]

use crate::StarError;
use crate::device::cuda_library;
use crate::error::CudaFault;
use libloading::os::unix::{Library, RTLD_GLOBAL, RTLD_NOW};
use std::marker::PhantomData;
use std::mem::ManuallyDrop;

/// Two words in registers: `MempoolId_t`, a `std::pair`, and `CUDAStream`.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
struct TwoWords(u64, u64);

/// Room for an object `at::cuda::CUDAGraph`, which has less than 300 bytes in this release.
type GraphObject = [u128; 64];

/// Functions of libtorch 2.11.0. Their exceptions end the process: Rust cannot catch them.
#[derive(Debug, Clone, Copy)]
struct GraphFunctions {
    construct: unsafe extern "C-unwind" fn(*mut GraphObject, bool),
    destroy: unsafe extern "C-unwind" fn(*mut GraphObject),
    begin: unsafe extern "C-unwind" fn(*mut GraphObject, TwoWords, i32),
    end: unsafe extern "C-unwind" fn(*mut GraphObject),
    replay: unsafe extern "C-unwind" fn(*mut GraphObject),
}

/// Records the work of this thread on its own stream. All records share a pool of memory, so what one replay has
/// computed must be read before the next one, and they must be replayed in the order in which they were recorded.
#[derive(Debug)]
pub(crate) struct Recorder {
    functions: GraphFunctions,
    pool: TwoWords,
    /// The stream is that of one thread.
    _of_thread: PhantomData<*const ()>,
}

/// Recorded work.
#[derive(Debug)]
pub(crate) struct RecordedWork {
    functions: GraphFunctions,
    object: Box<GraphObject>,
}

impl Recorder {
    /// Makes the thread work on a stream of its own from now on: the default stream cannot be recorded.
    ///
    /// # Errors
    /// [`StarError::Device`] when the loaded libraries are not those of the pinned release.
    pub(crate) fn begin() -> Result<Self, StarError> {
        let cuda = cuda_library().ok_or(CudaFault::NotOpened)?;
        // SAFETY: libtorch_cuda.so depends on this library, so it is loaded already and its initialisers have run.
        let c10 = unsafe { Library::open(Some("libc10_cuda.so"), RTLD_NOW | RTLD_GLOBAL) };
        let c10 = c10.map_err(|error| CudaFault::OtherRelease(error.to_string()))?;
        // SAFETY: the names encode the types of the arguments, which are those of the declared functions in the headers
        // of the pinned release: `CUDAGraph(bool)`, `~CUDAGraph()`, `capture_begin(MempoolId_t,
        // cudaStreamCaptureMode)`, `capture_end()`, `replay()`, `graph_pool_handle()`, `getStreamFromPool(bool,
        // DeviceIndex)` and `setCurrentCUDAStream(CUDAStream)`. Both structures have 16 bytes and trivial copies, and
        // the ABI of Linux on x86-64 and Arm passes and returns such in two registers. The stream stays valid until the
        // process ends. Waiting for the default stream orders it before the new one.
        unsafe {
            let functions = GraphFunctions {
                construct: *symbol(cuda, "_ZN2at4cuda9CUDAGraphC1Eb")?,
                destroy: *symbol(cuda, "_ZN2at4cuda9CUDAGraphD1Ev")?,
                begin: *symbol(cuda, "_ZN2at4cuda9CUDAGraph13capture_beginESt4pairIyyE21cudaStreamCaptureMode")?,
                end: *symbol(cuda, "_ZN2at4cuda9CUDAGraph11capture_endEv")?,
                replay: *symbol(cuda, "_ZN2at4cuda9CUDAGraph6replayEv")?,
            };
            let new_pool =
                symbol::<unsafe extern "C-unwind" fn() -> TwoWords>(cuda, "_ZN2at4cuda17graph_pool_handleEv")?;
            let stream = symbol::<unsafe extern "C-unwind" fn(bool, i8) -> TwoWords>(
                &c10,
                "_ZN3c104cuda17getStreamFromPoolEba",
            )?;
            let set_stream = symbol::<unsafe extern "C-unwind" fn(TwoWords)>(
                &c10,
                "_ZN3c104cuda20setCurrentCUDAStreamENS0_10CUDAStreamE",
            )?;
            tch::Cuda::synchronize(0);
            set_stream(stream(false, 0));
            let pool = new_pool();
            std::mem::forget(c10);
            Ok(Self { functions, pool, _of_thread: PhantomData })
        }
    }

    /// Records `work`, which is not done before [`RecordedWork::replay`]. It may not wait for the card, copy from or to
    /// the processor's memory, or seed the generator; a replay draws from the generator like the work itself.
    pub(crate) fn record<T>(&self, work: impl FnOnce() -> T) -> (RecordedWork, T) {
        let functions = self.functions;
        // Leaked if the work panics: the recording is then still open.
        let mut object = ManuallyDrop::new(Box::new([0; 64]));
        // SAFETY: the object has room and alignment, and stays in its place until it is destroyed. The thread works on
        // a stream of its own (`begin`).
        unsafe {
            (functions.construct)(&raw mut **object, false);
            (functions.begin)(&raw mut **object, self.pool, 0);
        }
        let made = work();
        // SAFETY: recording has begun.
        unsafe { (functions.end)(&raw mut **object) };
        let object = ManuallyDrop::into_inner(object);
        (RecordedWork { functions, object }, made)
    }
}

impl RecordedWork {
    /// Does the work again, on the memory that it was recorded with: every tensor that the work read or returned must
    /// still be there.
    pub(crate) fn replay(&mut self) {
        // SAFETY: the recording is complete.
        unsafe { (self.functions.replay)(&raw mut *self.object) };
    }
}

impl Drop for RecordedWork {
    fn drop(&mut self) {
        // SAFETY: constructed once, and destroyed here alone.
        unsafe { (self.functions.destroy)(&raw mut *self.object) };
    }
}

/// # Safety
/// `F` is the type of the function of that name.
unsafe fn symbol<F>(library: &Library, name: &str) -> Result<libloading::os::unix::Symbol<F>, CudaFault> {
    // SAFETY: by the caller.
    let found = unsafe { library.get(name.as_bytes()) };
    found.map_err(|error| CudaFault::OtherRelease(error.to_string()))
}
