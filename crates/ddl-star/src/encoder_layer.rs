//! One Transformer encoder layer: attention, then a feed-forward block, each with a residual
//! connection and normalised afterwards (post-norm, `ReLU`).
//!
//! In words of libtorch it is written here and in [`crate::attention`]; [`kernel::EncoderLayer`] computes all of it at once.

use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;

use crate::attention::MultiHeadAttention;
use crate::config::StarConfig;
use crate::dropout::dropout;
use crate::kernel::{self, Dropouts, Remembered, Sizes};
use crate::layers::{LayerNorm, Linear};
use crate::neighbours::Seen;
use crate::packed::Packed;
use crate::parameters::Initializer;
use crate::pass::Pass;
use crate::remembered::{KeyValue, RememberedRows};
use crate::tokens::{Rows, Tokens};
use tch::Tensor;

#[derive(Debug)]
pub(crate) struct EncoderLayer {
    attention: MultiHeadAttention,
    linear1: Linear,
    linear2: Linear,
    norm1: LayerNorm,
    norm2: LayerNorm,
    dropout: f64,
    sizes: Sizes,
    packed: Packed<kernel::EncoderLayer>,
}

impl EncoderLayer {
    pub(crate) fn new(
        init: &mut Initializer,
        name: &str,
        config: &StarConfig,
        dropout: f64,
    ) -> Self {
        let (width, hidden) = (config.model_width, config.feed_forward_width);
        let attention = format!("{name}.self_attn");
        let start = init.count();
        // In the order of `Sizes`.
        let attention = MultiHeadAttention::new(init, &attention, width, config.heads, dropout);
        let linear1 = Linear::new(init, &format!("{name}.linear1"), width, hidden);
        let linear2 = Linear::new(init, &format!("{name}.linear2"), hidden, width);
        let norm1 = LayerNorm::new(init, &format!("{name}.norm1"), width);
        let norm2 = LayerNorm::new(init, &format!("{name}.norm2"), width);
        Self {
            attention,
            linear1,
            linear2,
            norm1,
            norm2,
            dropout,
            sizes: Sizes {
                width: width as usize,
                heads: config.heads as usize,
                hidden: hidden as usize,
            },
            packed: Packed::new(init.since(start)),
        }
    }

    /// Every walker looks at its neighbours. Shapes as in [`MultiHeadAttention::among_walkers`].
    pub(crate) fn among_walkers(&self, x: &Tokens, seen: &Seen, pass: &Pass) -> Tokens {
        let x = match x {
            Tokens::Tensor(x) => {
                let attended = self.attention.among_walkers(x, seen, pass);
                return Tokens::Tensor(self.after_attention(x, attended, pass));
            }
            Tokens::Rows(x) => Rc::clone(x),
        };
        let (kernel, dropouts) = (self.kernel(pass), self.dropouts(pass));
        let (y, kept) = kernel.among_walkers(&x, seen.frames(), dropouts);
        let (seen, span) = (seen.clone(), self.packed.span());
        Tokens::Rows(pass.made(x.shape(), y, move |gy, of_weights| {
            let of_weights = &mut of_weights[span];
            let frames = seen.frames();
            let gx = kernel.among_walkers_backward(&x, frames, dropouts, &kept, gy, of_weights);
            x.add_gradient(gx);
        }))
    }

    /// The newest token looks at the remembered ones and itself.
    /// Shapes as in [`MultiHeadAttention::over_memory`].
    pub(crate) fn over_memory(&self, newest: &Tokens, memory: &[KeyValue], pass: &Pass) -> Tokens {
        match newest {
            Tokens::Tensor(x) => {
                let attended = self.attention.over_memory(x, memory, pass);
                Tokens::Tensor(self.after_attention(x, attended, pass))
            }
            Tokens::Rows(x) => Tokens::Rows(self.over_rows(x, memory, pass)),
        }
    }

    fn over_rows(&self, x: &Rc<Rows>, memory: &[KeyValue], pass: &Pass) -> Rc<Rows> {
        let memory: Vec<_> = memory.iter().filter_map(KeyValue::rows).collect();
        let (kernel, dropouts) = (self.kernel(pass), self.dropouts(pass));
        let (y, kept) = kernel.over_memory(x, &rows(&memory), dropouts);
        let (x, span) = (Rc::clone(x), self.packed.span());
        pass.made(x.shape(), y, move |gy, of_weights| {
            let mut shares: Vec<_> = memory.iter().map(|token| token.gradient.take()).collect();
            let mut of_memory: Vec<&mut Remembered> = shares
                .iter_mut()
                .map(|share| share.get_or_insert_with(|| Remembered::zeros(x.len())))
                .collect();
            x.add_gradient(kernel.over_memory_backward(
                &x,
                &rows(&memory),
                dropouts,
                &kept,
                gy,
                &mut of_memory,
                &mut of_weights[span],
            ));
            for (token, share) in memory.iter().zip(shares) {
                token.gradient.replace(share);
            }
        })
    }

    /// Keys and values of tokens, for later queries.
    pub(crate) fn remember(&self, token: &Tokens, pass: &Pass) -> KeyValue {
        let x = match token {
            Tokens::Tensor(x) => return self.attention.remember(x, pass),
            Tokens::Rows(x) => Rc::clone(x),
        };
        let kernel = self.kernel(pass);
        let remembered = Rc::new(RememberedRows {
            rows: kernel.remember(&x),
            gradient: RefCell::new(None),
        });
        let (token, span) = (Rc::clone(&remembered), self.packed.span());
        pass.on_the_way_back(move |of_weights| {
            if let Some(gradient) = token.gradient.take() {
                x.add_gradient(kernel.remember_backward(&x, &gradient, &mut of_weights[span]));
            }
        });
        KeyValue::Rows(remembered)
    }

    fn kernel(&self, pass: &Pass) -> Arc<kernel::EncoderLayer> {
        self.packed
            .of(pass, || kernel::EncoderLayer::zeros(self.sizes))
    }

    fn dropouts(&self, pass: &Pass) -> Dropouts {
        let [weights, attended, hidden, fed] = [0; 4].map(|_| pass.dropout(self.dropout));
        Dropouts {
            weights,
            attended,
            hidden,
            fed,
        }
    }

    fn after_attention(&self, x: &Tensor, attended: Tensor, pass: &Pass) -> Tensor {
        let attended = dropout(attended, self.dropout, pass.mode());
        let x = self.norm1.forward(&(x + attended));
        let hidden = self.linear1.forward(&x, pass).relu();
        let hidden = dropout(hidden, self.dropout, pass.mode());
        let fed = dropout(
            self.linear2.forward(&hidden, pass),
            self.dropout,
            pass.mode(),
        );
        self.norm2.forward(&(x + fed))
    }
}

fn rows(memory: &[Rc<RememberedRows>]) -> Vec<&Remembered> {
    memory.iter().map(|token| &token.rows).collect()
}
