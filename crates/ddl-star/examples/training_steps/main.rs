//! Training steps of the published network in double precision, where libtorch computes everything, as on CUDA.
//!
//! With the preloaded library from `operations.cpp` it counts the operations of libtorch in a step
//! (docs/performance.md):
//!
//! ```console
//! $ cargo run --release -p ddl-star --example training_steps -- STEPS DROPOUT
//! ```
//!
//! With the preloaded library from `operations.cpp` it counts the operations of libtorch in a step
//! (docs/performance.md), without views and allocations. A step is half the difference between three steps and one:
//!
//! ```console
//! $ eval "$(cargo xtask setup --env)"
//! $ cd crates/ddl-star/examples/training_steps
//! $ g++ -O1 -std=c++17 -shared -fPIC -I$LIBTORCH/include operations.cpp -o operations.so -L$LIBTORCH/lib -lc10
//! -ltorch_cpu
//! $ cargo build -p ddl-star --example training_steps
//! $ OPERATIONS=operations-1 LD_PRELOAD=./operations.so ../../../../target/debug/examples/training_steps 1 0
//! $ OPERATIONS=operations-3 LD_PRELOAD=./operations.so ../../../../target/debug/examples/training_steps 3 0
//! $ tail -qn 1 operations-1 operations-3
//! ```
#![allow(clippy::print_stdout, reason = "a command-line program answers on standard output")]

use ddl_data::{Dataset, WindowRule};
use ddl_network::{DeviceChoice, StarConfig, TrainingConfig, Variant};
use ddl_star::{ComputeDevice, TorchNetwork, Trainer};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut next = |default: &str| arguments.next().unwrap_or_else(|| default.to_owned());
    let (steps, dropout): (u64, f64) = (next("3").parse()?, next("0.1").parse()?);
    ddl_star::set_threads(1);
    let config = StarConfig {
        spatial_dropout: dropout,
        ..StarConfig::published(Variant::Full)
    };
    let cpu = ComputeDevice::open(DeviceChoice::Cpu)?;
    let network = TorchNetwork::with_precision(config, 1, cpu, tch::Kind::Double)?;
    // The number of operations does not depend on the number of pedestrians.
    let training = TrainingConfig {
        batch_pedestrians: 16,
        ..TrainingConfig::published()
    };
    let windows = Dataset::simulated(1).recordings()[0].windows(WindowRule::Complete);
    let mut trainer = Trainer::new(network, windows, training)?;
    for _ in 0..steps {
        trainer.step()?;
    }
    println!("{steps} steps, dropout {dropout}");
    Ok(())
}
