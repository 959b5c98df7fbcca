//! Random diffeomorphisms and paths, drawn as `f64` in three dimensions and cut down to the space
//! under test.

use ddl_dynamics::{AffineCoupling, Chain, CouplingBump, Layer, LocalTranslation, Real};
use nalgebra::SVector;
use proptest::{array::uniform3, collection::vec, prelude::*};

use crate::draw::{SceneDraw, any_scene, well_conditioned_scene, wild_scene};

/// `sqrt(2/e)`, from a table and not from the formula.
pub(crate) const STEEPEST: f64 = 0.857_763_884_960_706_8;

/// A local translation: centre, rate, contraction and direction.
type TranslationDraw = ([f64; 3], f64, f64, [f64; 3]);
/// A bump: centre, rate, weight in the log scale, shift.
type BumpDraw = ([f64; 3], f64, f64, f64);

/// Some maps, and positions in and out of their reach.
#[derive(Debug, Clone)]
pub(crate) struct MapDraw {
    translations: Vec<TranslationDraw>,
    couplings: Vec<(usize, f64, Vec<BumpDraw>)>,
    /// Positions relative to the first translation, in units of its width.
    near: Vec<[f64; 3]>,
    positions: Vec<[f64; 3]>,
}

fn rate() -> impl Strategy<Value = f64> {
    (-1.5..=1.0).prop_map(|exponent| 10_f64.powf(exponent))
}

fn centre() -> impl Strategy<Value = [f64; 3]> {
    uniform3(-10.0..=10.0)
}

fn coupling() -> impl Strategy<Value = (usize, f64, Vec<BumpDraw>)> {
    let bump = (centre(), rate(), -1.0..=1.0, -5.0..=5.0);
    (0..3_usize, 0.0..=1.0, vec(bump, 0..4))
}

/// Maps of the size of a room, up to the limit of invertibility.
pub(crate) fn any_maps() -> impl Strategy<Value = MapDraw> {
    let contraction = prop_oneof![0.0..=0.949, Just(0.949), Just(0.0)];
    let translation = (centre(), rate(), contraction, uniform3(-1.0..=1.0));
    (
        vec(translation, 2),
        vec(coupling(), 2),
        vec(uniform3(-2.5..=2.5), 6),
        vec(uniform3(-20.0..=20.0), 2),
    )
        .prop_map(|(translations, couplings, near, positions)| MapDraw {
            translations,
            couplings,
            near,
            positions,
        })
}

/// Every finite number there is: subnormal and huge ones included.
pub(crate) fn wild_maps() -> impl Strategy<Value = MapDraw> {
    use proptest::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    let wild = || {
        prop_oneof![
            POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO,
            -2.0..=2.0,
            Just(f64::MAX),
            Just(-f64::MAX)
        ]
    };
    let rate = || prop_oneof![POSITIVE | NORMAL | SUBNORMAL, 0.1..=10.0];
    let translation = (uniform3(wild()), rate(), 0.0..=0.949, uniform3(-1.0..=1.0));
    let bump = (uniform3(wild()), rate(), wild(), wild());
    (
        vec(translation, 2),
        vec((0..3_usize, 0.0..=10.0, vec(bump, 0..3)), 2),
        vec(uniform3(-2.5..=2.5), 4),
        vec(uniform3(wild()), 6),
    )
        .prop_map(|(translations, couplings, near, positions)| MapDraw {
            translations,
            couplings,
            near,
            positions,
        })
}

/// A draw too large for `T` becomes its largest number, so that it stays finite.
fn clamped<T: Real>(value: f64) -> T {
    T::rounded(value.clamp(-T::MAX.as_f64(), T::MAX.as_f64()))
}

fn vector<T: Real, const D: usize>(draw: &[f64; 3]) -> SVector<T, D> {
    SVector::from_fn(|i, _| clamped(draw[i]))
}

fn positive<T: Real>(rate: f64) -> T {
    clamped::<T>(rate).max(T::MIN_POSITIVE * T::EPSILON)
}

impl MapDraw {
    pub(crate) fn translations<T: Real, const D: usize>(&self) -> Vec<LocalTranslation<T, D>> {
        let translation = |(centre, rate, contraction, direction): &TranslationDraw| {
            let rate = positive::<T>(*rate);
            let mut unit = SVector::<f64, D>::from_fn(|i, _| direction[i]);
            unit = unit.try_normalize(1e-9).unwrap_or_else(SVector::zeros);
            let length = (contraction / STEEPEST / rate.as_f64()).min(T::MAX.as_f64());
            let translation = unit.map(|x| T::rounded(x * length));
            LocalTranslation::new(vector(centre), rate, translation).unwrap()
        };
        self.translations.iter().map(translation).collect()
    }

    /// The couplings; `None` for one whose bumps are too large together.
    pub(crate) fn couplings<T: Real, const D: usize>(&self) -> Vec<Option<AffineCoupling<T, D>>> {
        let bump = |(centre, rate, log_scale, shift): &BumpDraw| CouplingBump {
            centre: vector(centre),
            rate: positive(*rate),
            log_scale: clamped(*log_scale),
            shift: clamped(*shift),
        };
        self.couplings
            .iter()
            .map(|(moved, largest, bumps)| {
                let bumps = bumps.iter().map(bump).collect();
                AffineCoupling::new(moved % D, T::rounded(*largest), bumps).ok()
            })
            .collect()
    }

    /// Translations and couplings in turn.
    pub(crate) fn chain<T: Real, const D: usize>(&self) -> Chain<T, D> {
        let mut layers = Vec::<Layer<T, D>>::new();
        for (translation, coupling) in self.translations().into_iter().zip(self.couplings()) {
            layers.push(translation.into());
            layers.extend(coupling.map(Layer::from));
        }
        Chain::new(layers)
    }

    pub(crate) fn positions<T: Real, const D: usize>(&self) -> Vec<SVector<T, D>> {
        let (centre, rate, ..) = &self.translations[0];
        let near = self.near.iter().map(|offset| {
            SVector::from_fn(|i, _| clamped(centre[i] + offset[i] / positive::<T>(*rate).as_f64()))
        });
        near.chain(self.positions.iter().map(vector)).collect()
    }
}

/// A few points, some of them wild, some the same, some on a line.
#[derive(Debug, Clone)]
pub(crate) struct PolygonDraw(Vec<[f64; 3]>);

pub(crate) fn any_polygon() -> impl Strategy<Value = PolygonDraw> {
    use proptest::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    let usual = || prop_oneof![-5.0..=5.0, Just(0.0), Just(1.0)];
    prop_oneof![
        4 => vec(uniform3(usual()), 0..6),
        1 => vec(uniform3(POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO), 0..4),
    ]
    .prop_map(PolygonDraw)
}

impl PolygonDraw {
    pub(crate) fn points<T: Real, const D: usize>(&self) -> Vec<SVector<T, D>> {
        self.0.iter().map(vector).collect()
    }
}

/// Maps, and a scene for walkers in the space that they bend.
pub(crate) fn any_bent_scene() -> impl Strategy<Value = (MapDraw, SceneDraw)> {
    (any_maps(), any_scene())
}

/// The same with metrics of moderate condition.
pub(crate) fn mild_bent_scene() -> impl Strategy<Value = (MapDraw, SceneDraw)> {
    (any_maps(), well_conditioned_scene())
}

/// Every finite number there is, in the maps and in the scene.
pub(crate) fn wild_bent_scene() -> impl Strategy<Value = (MapDraw, SceneDraw)> {
    (wild_maps(), wild_scene())
}
