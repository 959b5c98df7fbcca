//! The handles of `ddl.h`, whose content C does not see.

#![allow(non_camel_case_types, reason = "names of C")]

use crate::answer::ShownAnswer;
use crate::live::LivePlace;
use crate::model::LoadedModel;

/// A trained model. Any number of threads may use it at the same time.
#[derive(Debug)]
pub struct ddl_model(pub(crate) LoadedModel);

/// The tracks of one place. Calls of several threads wait for each other. It keeps its model, which may be freed.
#[derive(Debug)]
pub struct ddl_live(pub(crate) LivePlace);

/// A forecast and the answers about it, in memory that the next forecast uses again. One thread at a time.
#[derive(Debug, Default)]
pub struct ddl_forecast(pub(crate) ShownAnswer);
