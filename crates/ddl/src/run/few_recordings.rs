//! What training on few own recordings starts from.

use crate::error::DdlError;
use crate::run::builtin_model::BuiltinModel;
use crate::run::folds::fold_by_name;
use crate::run::validation_part::ValidationPart;
use ddl_core::Window;
use ddl_data::{Convention, Dataset};

/// Number of pedestrian-windows below which training on own recordings starts from a built-in model.
const FEW: usize = 10_000;

/// The model that training on own recordings starts from, with the number of pedestrian-windows of the training, if
/// there are few of them; `None` for random weights.
///
/// # Errors
/// The fold or a recording of the validation part is not known.
pub fn starting_model(
    dataset: &Dataset,
    fold: &str,
    part: &ValidationPart,
) -> Result<Option<(BuiltinModel, usize)>, DdlError> {
    if dataset.convention() != Convention::Own {
        return Ok(None);
    }
    let fold = fold_by_name(dataset, fold)?.with_validation_recordings(&part.recordings)?;
    let rule = dataset.convention().headline_rule();
    let windows = fold.training_split(rule, part.share.clamp(0.0, 1.0)).training;
    let pedestrians: usize = windows.iter().map(Window::len).sum();
    Ok((pedestrians > 0 && pedestrians < FEW).then(|| (BuiltinModel::default(), pedestrians)))
}
