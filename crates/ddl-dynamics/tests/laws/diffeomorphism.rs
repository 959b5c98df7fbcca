//! Diffeomorphisms: one-to-one, onto, and consistent with their Jacobians.

use approx::assert_relative_eq;
use ddl_dynamics::{Chain, Diffeomorphism, DynamicsError, LocalTranslation, Real};
use nalgebra::{ComplexField, DMatrix, SMatrix, SVector, Vector2};
use proptest::{prelude::*, test_runner::TestCaseResult};

use crate::{
    for_every_space,
    map_draw::{MapDraw, STEEPEST, wild_maps},
};

fn double<T: Real, const D: usize>(vector: &SVector<T, D>) -> SVector<f64, D> {
    vector.map(Real::as_f64)
}

/// A matrix in `f64` and of dynamic size, which nalgebra can decompose in any dimension.
fn general<T: Real, const D: usize>(matrix: &SMatrix<T, D, D>) -> DMatrix<f64> {
    DMatrix::from_fn(D, D, |row, column| matrix[(row, column)].as_f64())
}

fn twin<T: Real, const D: usize>(chain: &Chain<T, D>) -> Chain<f64, D> {
    let layer = |map: &LocalTranslation<T, D>| {
        let [centre, translation] = [map.centre(), map.translation()].map(double);
        LocalTranslation::new(centre, map.rate().as_f64(), translation).unwrap()
    };
    Chain::new(chain.layers().iter().map(layer).collect())
}

fn chains<T: Real, const D: usize>(draw: &MapDraw) -> Vec<Chain<T, D>> {
    let all = draw.translations();
    let alone = all.iter().map(|&layer| Chain::new(vec![layer]));
    alone.chain([Chain::new(all.clone())]).collect()
}

fn stretch<T: Real, const D: usize>(map: &Chain<T, D>, position: &SVector<T, D>) -> (f64, f64) {
    let values = general(&map.jacobian(position)).singular_values();
    (values.max(), 1.0 / values.min())
}

/// `psi^-1(psi(x)) = x` and `psi(psi^-1(y)) = y`, to 1e-9 m in `f64` (positions within 200 m). In both types also to
/// some hundred rounding errors times the magnification of the map.
fn the_inverse_undoes_the_map<T: Real, const D: usize>(draw: &MapDraw) -> TestCaseResult {
    for chain in chains::<T, D>(draw) {
        for position in draw.positions::<T, D>() {
            let image = chain.apply(&position);
            let source = chain.inverse(&position);
            let (large, small) = stretch(&chain, &position);
            let (large_there, small_there) = stretch(&chain, &source);
            let size = 40.0 + double(&position).norm() + double(&image).norm() + double(&source).norm();
            let magnified = (1.0 + large.max(large_there)) * (1.0 + small.max(small_there));
            let tolerance = 200.0 * T::EPSILON.as_f64() * size * magnified;
            let back = (double(&chain.inverse(&image)) - double(&position)).norm();
            let forth = (double(&chain.apply(&source)) - double(&position)).norm();
            prop_assert!(back.max(forth) <= tolerance, "{back} {forth} {tolerance}");
            if T::EPSILON.as_f64() < 1e-15 {
                prop_assert!(back.max(forth) <= 1e-9, "{back} {forth}");
            }
        }
    }
    Ok(())
}
for_every_space!(the_inverse_undoes_the_map, any_maps);

/// A single translation is inverted to a few rounding errors, without allowance for its magnification, for every finite
/// parameter and position.
fn a_translation_is_undone_to_rounding<T: Real, const D: usize>(draw: &MapDraw) -> TestCaseResult {
    for map in draw.translations::<T, D>() {
        for image in draw.positions::<T, D>() {
            let back = map.apply(&map.inverse(&image));
            let size = image.amax().max(map.centre().amax()).as_f64() + map.translation().amax().as_f64();
            // The smallest number covers the loss below the normal numbers.
            let tolerance = 64.0 * T::EPSILON.as_f64() * size
                + 8.0 * f64::MIN_POSITIVE.max((T::MIN_POSITIVE * T::EPSILON).as_f64());
            if size < T::MAX.as_f64() / 16.0 {
                let error = (double(&back) - double(&image)).amax();
                prop_assert!(error <= tolerance, "{error:e} {tolerance:e}");
            }
        }
    }
    Ok(())
}
for_every_space!(a_translation_is_undone_to_rounding, wild_maps);

fn the_jacobian_is_the_derivative<T: Real, const D: usize>(draw: &MapDraw) -> TestCaseResult {
    for chain in chains::<T, D>(draw) {
        let twin = twin(&chain);
        for position in draw.positions::<T, D>() {
            let (image, jacobian) = chain.apply_with_jacobian(&position);
            prop_assert_eq!(image, chain.apply(&position));
            prop_assert_eq!(jacobian, chain.jacobian(&position));
            let jacobian = jacobian.map(Real::as_f64);
            // Rates are up to 10 per metre; errors h^2 and epsilon / h.
            let step = 2e-6;
            let exact = twin.jacobian(&double(&position));
            for column in 0..D {
                let mut to_side = SVector::<f64, D>::zeros();
                to_side[column] = step;
                let ahead = twin.apply(&(double(&position) + to_side));
                let behind = twin.apply(&(double(&position) - to_side));
                let difference = (ahead - behind) / (2.0 * step);
                let error = (difference - exact.column(column)).norm();
                prop_assert!(error <= 1e-6 * (1.0 + exact.norm()), "{error}");
            }
            // In T, the rounding of the positions between layers is multiplied by the rate of change of J.
            let rounding = 1e5 * T::EPSILON.as_f64() * (1.0 + exact.norm()).powi(2);
            prop_assert!((jacobian - exact).norm() <= rounding);
        }
    }
    Ok(())
}
for_every_space!(the_jacobian_is_the_derivative, any_maps);

/// `det J` is positive and not below the stated bound of each map. The singular values of a translation are within
/// `[1 - q, 1 + q]`.
fn space_is_never_folded<T: Real, const D: usize>(draw: &MapDraw) -> TestCaseResult {
    for chain in chains::<T, D>(draw) {
        for position in draw.positions::<T, D>() {
            let jacobian = general(&chain.jacobian(&position));
            let rounding = 64.0 * T::EPSILON.as_f64() * (1.0 + jacobian.norm()).powi(3);
            let bound = chain.log_determinant_lower_bound().as_f64().exp();
            prop_assert!(bound > 0.0);
            prop_assert!(jacobian.determinant() >= bound - rounding);
            if let [map] = chain.layers() {
                let q = map.contraction().as_f64();
                prop_assert!(jacobian.determinant() >= 0.05);
                let values = jacobian.singular_values();
                prop_assert!(values.min() >= 1.0 - q - rounding);
                prop_assert!(values.max() <= 1.0 + q + rounding);
            }
        }
    }
    Ok(())
}
for_every_space!(space_is_never_folded, any_maps);

fn far_away_nothing_moves<T: Real, const D: usize>(draw: &MapDraw) -> TestCaseResult {
    for map in draw.translations::<T, D>() {
        let mut far = *map.centre();
        far[0] += T::rounded(30.0) / map.rate();
        prop_assert_eq!(map.apply(&far), far);
        prop_assert_eq!(map.inverse(&far), far);
    }
    Ok(())
}
for_every_space!(far_away_nothing_moves, any_maps);

fn no_finite_input_gives_nan<T: Real, const D: usize>(draw: &MapDraw) -> TestCaseResult {
    let number = |vector: SVector<T, D>| vector.iter().all(|x| !x.as_f64().is_nan());
    for position in draw.positions::<T, D>() {
        for map in draw.translations::<T, D>() {
            prop_assert!(number(map.apply(&position)) && number(map.inverse(&position)));
            prop_assert!(map.jacobian(&position).iter().all(ComplexField::is_finite));
        }
        let chain = draw.chain::<T, D>();
        prop_assert!(number(chain.apply(&position)) && number(chain.inverse(&position)));
        let _ = chain.jacobian(&position);
    }
    Ok(())
}
for_every_space!(no_finite_input_gives_nan, wild_maps);

proptest! {
    #[test]
    fn a_chain_survives_json(draw in wild_maps()) {
        let (wide, narrow) = (draw.chain::<f64, 3>(), draw.chain::<f32, 2>());
        let [text, short] = [serde_json::to_string(&wide), serde_json::to_string(&narrow)].map(Result::unwrap);
        let back: Chain<f64, 3> = serde_json::from_str(&text).unwrap();
        prop_assert_eq!(&serde_json::from_str::<Chain<f32, 2>>(&short).unwrap(), &narrow);
        prop_assert_eq!(&back, &wide);
        // Equality does not distinguish 0 and -0.
        prop_assert_eq!(serde_json::to_string(&back).unwrap(), text);
    }
}

#[test]
fn maps_that_are_not_invertible_are_refused() {
    let new = |x: f64, rate: f64, v: f64| LocalTranslation::new(Vector2::new(0.0, x), rate, Vector2::new(v, 0.0));
    let refused = |x, rate, v, message: &str| {
        let error = new(x, rate, v).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    };
    let rate = "the rate of a Gaussian bump is";
    refused(0.0, 0.0, 0.0, &format!("{rate} 0 per metre"));
    refused(0.0, -1.0, 0.0, &format!("{rate} -1 per metre"));
    refused(0.0, f64::NAN, 0.0, &format!("{rate} NaN"));
    refused(f64::NAN, 1.0, 0.0, "component 1 of the centre is NaN");
    refused(0.0, 1.0, f64::INFINITY, "component 0 of the translation is inf");
    refused(0.0, f64::MAX, f64::MAX, "the local translation is not invertible");
    refused(
        0.0,
        1.0,
        2.0,
        "and must be at most 0.95; shorten the translation v or lower the rate rho",
    );
    // The limit itself is accepted, a slightly larger value is not.
    let limit = 0.95 / STEEPEST;
    assert!(new(0.0, 2.0, limit * 0.5 * (1.0 - 1e-14)).is_ok());
    let error = new(0.0, 2.0, limit * 0.501).unwrap_err();
    let DynamicsError::NotInvertible { contraction, .. } = error else {
        panic!("{error}")
    };
    assert_relative_eq!(contraction, 0.95 * 1.002, epsilon = 1e-14);
}

#[test]
fn forged_files_are_refused() {
    let read = |translation: serde_json::Value| {
        let chain = serde_json::json!({"layers": [translation]});
        serde_json::from_value::<Chain<f64, 2>>(chain)
    };
    let honest = serde_json::json!({"centre": [0.0, 1.0], "rate": 1.0, "translation": [0.5, 0.0]});
    assert_eq!(read(honest.clone()).unwrap().layers().len(), 1);
    for (field, value, message) in [
        ("rate", serde_json::json!(4.0), "not invertible"),
        ("rate", serde_json::json!(-1.0), "positive and finite"),
        ("rate", serde_json::Value::Null, "null"),
        ("centre", serde_json::json!([0.0]), "invalid length"),
        ("translation", serde_json::json!([0.1, 0.1, 0.1]), "invalid length"),
        ("center", serde_json::json!([0.0, 0.0]), "unknown field"),
    ] {
        let mut forged = honest.clone();
        forged[field] = value;
        let error = read(forged).unwrap_err().to_string();
        assert!(error.contains(message), "{field}: {error}");
    }
    assert!(read(serde_json::json!({})).is_err());
}
