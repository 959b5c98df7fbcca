//! Training steps on a card, recorded for each batch at its first visit and replayed at the others.

use crate::StarError;
use crate::cuda_graph::{Recorder, Recording};
use crate::training::draws::StepDraw;
use crate::training::prepared::TrainingBatch;
use tch::Tensor;

/// Steps before the first record: libtorch sets up its libraries and their memory while it computes.
const FIRST_STEPS: usize = 2;

/// The recorded steps of a training.
#[derive(Debug)]
pub(crate) struct RecordedSteps {
    recorder: Recorder,
    /// The tensors that records read instead of the draws of a step.
    inputs: Option<StepDraw>,
    computed: usize,
    /// Of each batch.
    steps: Vec<Option<RecordedStep>>,
}

#[derive(Debug)]
struct RecordedStep {
    recording: Recording,
    loss: Tensor,
    gradient: Tensor,
}

impl RecordedSteps {
    /// For `batches` batches, on this thread.
    ///
    /// # Errors
    /// As [`Recorder::begin`].
    pub(crate) fn new(batches: usize) -> Result<Self, StarError> {
        Ok(Self {
            recorder: Recorder::begin()?,
            inputs: None,
            computed: 0,
            steps: (0..batches).map(|_| None).collect(),
        })
    }

    /// Loss and gradient of a step, with the generator seeded before: what `compute` returns for the batch of that
    /// index and these draws. They are valid until the next call.
    ///
    /// # Errors
    /// Those of `compute`.
    pub(crate) fn gradient(
        &mut self,
        index: usize,
        batch: &TrainingBatch,
        draw: &StepDraw,
        compute: impl Fn(&StepDraw) -> Result<(Tensor, Tensor), StarError>,
    ) -> Result<(Tensor, Tensor), StarError> {
        if self.computed < FIRST_STEPS {
            self.computed += 1;
            return compute(draw);
        }
        let inputs = self.inputs.get_or_insert_with(|| draw.copied());
        inputs.set(draw)?;
        let place = &mut self.steps[index];
        let step = if let Some(step) = place {
            step
        } else {
            // Copied to the card before the record.
            let _ = batch.scenes.seen(0..1);
            let (recording, computed) = self.recorder.record(|| compute(inputs));
            let (loss, gradient) = computed?;
            place.insert(RecordedStep {
                recording,
                loss: loss.detach(),
                gradient,
            })
        };
        step.recording.replay();
        Ok((step.loss.shallow_clone(), step.gradient.shallow_clone()))
    }
}
