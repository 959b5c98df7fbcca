//! Random diffeomorphisms and paths, drawn as `f64` in three dimensions and reduced to the space under test.

use ddl_dynamics::{Chain, LocalTranslation, Real};
use nalgebra::SVector;
use proptest::{array::uniform3, collection::vec, prelude::*};

use crate::draw::{SceneDraw, any_scene, vector, wild, wild_scene};

/// `sqrt(2/e)`, from a table and not from the formula.
pub(crate) const STEEPEST: f64 = 0.857_763_884_960_706_8;

type TranslationDraw = ([f64; 3], f64, f64, [f64; 3]);

#[derive(Debug, Clone)]
pub(crate) struct MapDraw {
    translations: Vec<TranslationDraw>,
    /// Positions relative to the first translation, in units of its width.
    near: Vec<[f64; 3]>,
    positions: Vec<[f64; 3]>,
}

fn maps(
    translation: impl Strategy<Value = TranslationDraw>,
    positions: impl Strategy<Value = Vec<[f64; 3]>>,
) -> impl Strategy<Value = MapDraw> {
    let near = vec(uniform3(-2.5..=2.5), 6);
    (vec(translation, 3), near, positions).prop_map(|(translations, near, positions)| MapDraw {
        translations,
        near,
        positions,
    })
}

/// Maps of the size of a room, up to the limit of invertibility.
pub(crate) fn any_maps() -> impl Strategy<Value = MapDraw> {
    let rate = (-1.5..=1.0).prop_map(|exponent| 10_f64.powf(exponent));
    let contraction = prop_oneof![0.0..=0.949, Just(0.949), Just(0.0)];
    let direction = uniform3(-1.0..=1.0);
    let translation = (uniform3(-10.0..=10.0), rate, contraction, direction);
    maps(translation, vec(uniform3(-20.0..=20.0), 2))
}

pub(crate) fn wild_maps() -> impl Strategy<Value = MapDraw> {
    use proptest::num::f64::{NORMAL, POSITIVE, SUBNORMAL};
    let any = || prop_oneof![wild(), -2.0..=2.0, Just(f64::MAX), Just(-f64::MAX)];
    let rate = prop_oneof![POSITIVE | NORMAL | SUBNORMAL, 0.1..=10.0];
    let translation = (uniform3(any()), rate, 0.0..=0.949, uniform3(-1.0..=1.0));
    maps(translation, vec(uniform3(any()), 6))
}

fn positive<T: Real>(rate: f64) -> T {
    T::rounded(rate.min(T::MAX.as_f64())).max(T::MIN_POSITIVE * T::EPSILON)
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

    pub(crate) fn chain<T: Real, const D: usize>(&self) -> Chain<T, D> {
        Chain::new(self.translations())
    }

    pub(crate) fn positions<T: Real, const D: usize>(&self) -> Vec<SVector<T, D>> {
        let (centre, rate, ..) = &self.translations[0];
        let width = 1.0 / positive::<T>(*rate).as_f64();
        let near = self.near.iter();
        let near = near.map(|offset| vector(&[0, 1, 2].map(|i| centre[i] + offset[i] * width)));
        near.chain(self.positions.iter().map(vector)).collect()
    }
}

/// A few points; some are extreme, some equal, some on a line.
#[derive(Debug, Clone)]
pub(crate) struct PolygonDraw(Vec<[f64; 3]>);

pub(crate) fn any_polygon() -> impl Strategy<Value = PolygonDraw> {
    let usual = || prop_oneof![-5.0..=5.0, Just(0.0), Just(1.0)];
    prop_oneof![
        4 => vec(uniform3(usual()), 0..6),
        1 => vec(uniform3(wild()), 0..4),
    ]
    .prop_map(PolygonDraw)
}

impl PolygonDraw {
    pub(crate) fn points<T: Real, const D: usize>(&self) -> Vec<SVector<T, D>> {
        self.0.iter().map(vector).collect()
    }
}

pub(crate) fn any_bent_scene() -> impl Strategy<Value = (MapDraw, SceneDraw)> {
    (any_maps(), any_scene())
}

pub(crate) fn wild_bent_scene() -> impl Strategy<Value = (MapDraw, SceneDraw)> {
    (wild_maps(), wild_scene())
}
