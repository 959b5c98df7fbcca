//! Rows that do not fit their tracks.

use ddl_core::PedestrianId;

/// A row too far from where its pedestrian was expected.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Misfit {
    /// Tick of the wrong row or, where a track begins anew, of the row that confirmed the jump.
    pub tick: i64,
    /// Its pedestrian.
    pub pedestrian: PedestrianId,
    /// Distance from where the pedestrian was expected (m).
    pub distance: f64,
    /// How the row is treated.
    pub treatment: MisfitTreatment,
}

/// How a row is treated that is too far from where its pedestrian was expected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MisfitTreatment {
    /// It is left out.
    LeftOut,
    /// The track begins anew, as of another pedestrian.
    BegunAnew,
}

impl Misfit {
    /// A sentence about these rows, `None` without any; `place` names a row.
    pub fn words(misfits: &[Self], place: impl Fn(&Self) -> String) -> Option<String> {
        let first = misfits.first()?;
        let jumps = misfits.iter().filter(|misfit| misfit.treatment == MisfitTreatment::BegunAnew).count();
        let left_out = match misfits.len() - jumps {
            0 => None,
            1 => Some("1 position is left out as implausible".to_owned()),
            count => Some(format!("{count} positions are left out as implausible")),
        };
        let begun_anew = match jumps {
            0 => None,
            1 => Some("1 track begins anew after a jump".to_owned()),
            count => Some(format!("{count} tracks begin anew after a jump")),
        };
        let counts: Vec<String> = left_out.into_iter().chain(begun_anew).collect();
        Some(format!(
            "{}: first {}, {:.1} m from where it was expected",
            counts.join(", and "),
            place(first),
            first.distance
        ))
    }
}
