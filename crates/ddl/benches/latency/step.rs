//! One step of training.

use crate::Result;
use crate::clock::{MeasuredTime, side_by_side};
use ddl::data::{Dataset, Window, WindowRule};
use ddl::network::{StarConfig, TrainingConfig};
use ddl::star::{ComputeDevice, TorchNetwork, Trainer};
use ddl::{DeviceChoice, Variant};

/// A step with this number of threads of the CPU; `None` for a card.
pub(crate) fn measured(dataset: &Dataset, threads: Option<usize>, turns: usize) -> Result<String> {
    let training = TrainingConfig {
        epochs: 1_000_000, // never done
        ..TrainingConfig::published()
    };
    let windows = one_batch(dataset, training.batch_pedestrians)?;
    let scenes: Vec<usize> = windows.iter().map(Window::len).collect();
    let star = StarConfig::published(Variant::Full);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or(1))
        .build()?;
    let (clock, time) = match threads {
        Some(1) => (MeasuredTime::Processor, "processor time"),
        _ => (MeasuredTime::Wall, "wall-clock time"),
    };
    let device = match threads {
        Some(_) => DeviceChoice::Cpu,
        None => DeviceChoice::Cuda,
    };
    let [step] = pool.install(|| {
        let device = ComputeDevice::open(device)?;
        let mut trainer = Trainer::new(TorchNetwork::new(star, 1, device)?, windows, None, training)?;
        let work: &mut dyn FnMut() -> Result<()> = &mut || Ok(trainer.step().map(drop)?);
        side_by_side(clock, turns, [work])
    })?;
    let place = threads.map_or("on CUDA".into(), |threads| format!("threads: {threads}"));
    Ok(format!(
        "{} pedestrians in {} scenes, {place}: {step:.3} s ({time})",
        scenes.iter().sum::<usize>(),
        scenes.len(),
    ))
}

/// One batch of training windows with few pedestrians each, as in most recordings; together they hold more than
/// `pedestrians`.
fn one_batch(dataset: &Dataset, pedestrians: usize) -> Result<Vec<Window>> {
    let windows = dataset.fold("corridor")?.training_windows(WindowRule::Complete);
    let mut batch = Vec::new();
    let mut count = 0;
    for window in windows.into_iter().step_by(40) {
        count += window.len();
        batch.push(window);
        if count > pedestrians {
            return Ok(batch);
        }
    }
    Err("too few training windows".into())
}
