//! Dropout (Srivastava et al. 2014) from few random numbers.

use ddl_network::backend::Mode;
use tch::{Kind, Tensor};

/// Sets each entry to 0 with probability `p` and scales the others by 1 / (1 - p).
///
/// On the CPU the generator makes 64 bits at a time, and libtorch uses them all for one decision. Here they are used
/// for four decisions of 16 bits each. The distribution is the same, with p rounded to a multiple of 1/65536.
pub(crate) fn dropout(x: Tensor, p: f64, mode: Mode) -> Tensor {
    if mode == Mode::Evaluate || p == 0.0 {
        return x;
    }
    if x.device().is_cuda() {
        // One kernel with cheap random numbers.
        return x.dropout(p, true);
    }
    let count = x.numel() as i64;
    let words = count.div_euclid(4) + 1;
    let mut random = Tensor::empty([words], (Kind::Int64, x.device()));
    let _ = random.random_from_(i64::MIN, None);
    let dropped = (p * 65_536.0).round();
    // 16 random bits lie in [-32768, 32767]; the lowest `dropped` values drop the entry.
    let keep = random
        .view_dtype(Kind::Int16)
        .narrow(0, 0, count)
        .view(x.size().as_slice())
        .ge(dropped - 32_768.0)
        .to_kind(x.kind());
    x * (keep * (65_536.0 / (65_536.0 - dropped)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use tch::Device;

    #[test]
    fn drops_the_right_share_and_keeps_the_mean() {
        tch::manual_seed(1);
        let ones = Tensor::ones([1000, 1003], (Kind::Double, Device::Cpu));
        let dropped = dropout(ones.shallow_clone(), 0.1, Mode::Train);
        let mean = dropped.mean(None::<Kind>).double_value(&[]);
        assert!((mean - 1.0).abs() < 2e-3, "{mean}"); // standard error 3.3e-4
        let zeros = dropped.eq(0.0).to_kind(Kind::Double);
        let share = zeros.mean(None::<Kind>).double_value(&[]);
        assert!((share - 0.1).abs() < 2e-3, "{share}");
        // Every column has the same share of zeros, because the four parts of the 64 bits are equally distributed.
        let columns = zeros.mean_dim([0i64].as_slice(), false, None::<Kind>);
        let worst = (columns - 0.1).abs().max().double_value(&[]);
        assert!(worst < 0.06, "{worst}"); // standard error 0.0095
    }
}
