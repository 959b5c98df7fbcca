//! Training steps on a card: a batch that is visited often is recorded and replayed.

use crate::StarError;
use crate::cuda_graph::{RecordedWork, Recorder};
use crate::training::draws::StepDraw;
use tch::Tensor;

/// Visits of a batch before it is recorded, which takes longer than computing. libtorch sets up its libraries and their
/// memory in the first.
const COMPUTED_VISITS: usize = 2;
/// Most recorded batches; more are computed at every visit. 143 batches of the published size take 6 GB.
const MOST_RECORDED: usize = 512;

/// The recorded steps of a training.
#[derive(Debug)]
pub(crate) struct RecordedSteps {
    recorder: Recorder,
    /// The tensors that records read instead of the draws of a step.
    inputs: Option<StepDraw>,
    recorded: usize,
    /// Of each batch.
    steps: Vec<BatchStep>,
}

#[derive(Debug)]
enum BatchStep {
    /// After this number of visits.
    Computed(usize),
    Recorded {
        recording: RecordedWork,
        loss: Tensor,
        gradient: Tensor,
    },
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
            recorded: 0,
            steps: (0..batches).map(|_| BatchStep::Computed(0)).collect(),
        })
    }

    /// Loss and gradient of a step, with the generator seeded before: what `compute` returns for the batch of that
    /// index and these draws. They are valid until the next call. The batch is on the card already.
    ///
    /// # Errors
    /// Those of `compute`. One that it meets while it is recorded ends the process.
    pub(crate) fn gradient(
        &mut self,
        index: usize,
        draw: &StepDraw,
        compute: impl Fn(&StepDraw) -> Result<(Tensor, Tensor), StarError>,
    ) -> Result<(Tensor, Tensor), StarError> {
        let step = &mut self.steps[index];
        if let BatchStep::Computed(visits) = step {
            if *visits < COMPUTED_VISITS || self.recorded >= MOST_RECORDED {
                *visits += 1;
                return compute(draw);
            }
            let inputs = self.inputs.get_or_insert_with(|| draw.copied());
            let (recording, computed) = self.recorder.record(|| compute(inputs));
            let (loss, gradient) = computed?;
            let loss = loss.detach();
            *step = BatchStep::Recorded { recording, loss, gradient };
            self.recorded += 1;
        }
        if let Some(inputs) = &mut self.inputs {
            inputs.set(draw)?;
        }
        match step {
            BatchStep::Computed(_) => compute(draw),
            BatchStep::Recorded { recording, loss, gradient } => {
                recording.replay();
                Ok((loss.shallow_clone(), gradient.shallow_clone()))
            }
        }
    }
}
