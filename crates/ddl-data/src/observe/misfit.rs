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
    /// It goes on from the track of another, who exchanged its id with this pedestrian.
    Exchanged,
}

impl Misfit {
    /// A sentence about these rows, `None` without any; `place` names a row.
    pub fn words(misfits: &[Self], place: impl Fn(&Self) -> String) -> Option<String> {
        let first = misfits.first()?;
        let told = |treatment, one: &str, many: &str| match misfits
            .iter()
            .filter(|misfit| misfit.treatment == treatment)
            .count()
        {
            0 => None,
            1 => Some(format!("1 {one}")),
            count => Some(format!("{count} {many}")),
        };
        let treatments = [
            told(
                MisfitTreatment::LeftOut,
                "position is left out as implausible",
                "positions are left out as implausible",
            ),
            told(MisfitTreatment::BegunAnew, "track begins anew after a jump", "tracks begin anew after a jump"),
            told(
                MisfitTreatment::Exchanged,
                "pedestrian goes on under the id of another",
                "pedestrians go on under exchanged ids",
            ),
        ];
        let counts: Vec<String> = treatments.into_iter().flatten().collect();
        Some(format!(
            "{}: first {}, {:.1} m from where it was expected",
            counts.join(", and "),
            place(first),
            first.distance
        ))
    }
}
