//! Maps that would fold space over, or have no meaning, are refused: by constructors and from files.

use approx::assert_relative_eq;
use ddl_dynamics::{AffineCoupling, Chain, CouplingBump, DynamicsError, LocalTranslation};
use nalgebra::Vector2;

use crate::map_draw::STEEPEST;

#[test]
fn what_cannot_be_inverted_is_refused() {
    let new = |x: f64, rate: f64, v: f64| {
        LocalTranslation::new(Vector2::new(0.0, x), rate, Vector2::new(v, 0.0))
    };
    let refused = |x, rate, v| new(x, rate, v).unwrap_err();
    assert_eq!(refused(0.0, 0.0, 0.0), DynamicsError::InvalidRate(0.0));
    assert_eq!(refused(0.0, -1.0, 0.0), DynamicsError::InvalidRate(-1.0));
    assert!(matches!(
        refused(0.0, f64::NAN, 0.0),
        DynamicsError::InvalidRate(_)
    ));
    assert!(matches!(
        refused(f64::NAN, 1.0, 0.0),
        DynamicsError::NonFinite {
            quantity: "centre",
            component: 1,
            ..
        }
    ));
    assert!(matches!(
        refused(0.0, 1.0, f64::INFINITY),
        DynamicsError::NonFinite {
            quantity: "translation",
            component: 0,
            ..
        }
    ));
    // The limit itself is accepted, a little more is not.
    let limit = 0.95 / STEEPEST;
    assert!(new(0.0, 2.0, limit * 0.5 * (1.0 - 1e-14)).is_ok());
    let DynamicsError::NotInvertible {
        contraction,
        largest,
    } = refused(0.0, 2.0, limit * 0.501)
    else {
        panic!("not the expected error")
    };
    assert_relative_eq!(contraction, 0.95 * 1.002, epsilon = 1e-14);
    assert_relative_eq!(largest, 0.95);
    assert!(matches!(
        refused(0.0, f64::MAX, f64::MAX),
        DynamicsError::NotInvertible { .. }
    ));
    assert!(
        refused(0.0, 1.0, 2.0)
            .to_string()
            .ends_with("lower the rate rho")
    );
}

#[test]
fn couplings_that_have_no_meaning_are_refused() {
    let bump = CouplingBump {
        centre: Vector2::new(0.0, 1.0),
        rate: 1.0,
        log_scale: 1.0,
        shift: 1.0,
    };
    let refused = |moved, largest: f64, bump| {
        AffineCoupling::<f64, 2>::new(moved, largest, vec![bump]).unwrap_err()
    };
    assert_eq!(
        refused(2, 1.0, bump),
        DynamicsError::NoSuchCoordinate {
            coordinate: 2,
            dimension: 2
        }
    );
    for value in [-0.5, 10.5, f64::INFINITY] {
        assert_eq!(
            refused(0, value, bump),
            DynamicsError::InvalidLogScale {
                value,
                largest: 10.0
            }
        );
    }
    assert!(matches!(
        refused(0, f64::NAN, bump),
        DynamicsError::InvalidLogScale { .. }
    ));
    assert_eq!(
        refused(0, 1.0, CouplingBump { rate: -2.0, ..bump }),
        DynamicsError::InvalidRate(-2.0)
    );
    for wrong in [
        CouplingBump {
            shift: f64::NAN,
            ..bump
        },
        CouplingBump {
            log_scale: f64::INFINITY,
            ..bump
        },
        CouplingBump {
            centre: Vector2::new(f64::NAN, 0.0),
            ..bump
        },
    ] {
        assert!(matches!(
            refused(0, 1.0, wrong),
            DynamicsError::NonFinite { .. }
        ));
    }
    for large in [
        CouplingBump {
            shift: f64::MAX,
            ..bump
        },
        CouplingBump {
            shift: 1e200,
            rate: 1e200,
            ..bump
        },
    ] {
        assert_eq!(refused(0, 1.0, large), DynamicsError::BumpsTooLarge);
    }
}

#[test]
fn forged_files_are_refused() {
    let honest = serde_json::json!({"layers": [
        {"local-translation": {"centre": [0.0, 1.0], "rate": 1.0, "translation": [0.5, 0.0]}},
        {"affine-coupling": {"moved": 1, "largest_log_scale": 0.5, "bumps": [
            {"centre": [0.0, 0.0], "rate": 2.0, "log_scale": 0.5, "shift": -1.0},
        ]}},
    ]});
    let read = |value| serde_json::from_value::<Chain<f64, 2>>(value);
    assert_eq!(read(honest.clone()).unwrap().layers().len(), 2);
    let forged = |pointer: &str, value: serde_json::Value| {
        let mut forged = honest.clone();
        *forged.pointer_mut(pointer).unwrap() = value;
        read(forged).unwrap_err().to_string()
    };
    let translation = "/layers/0/local-translation";
    let coupling = "/layers/1/affine-coupling";
    for (pointer, value, message) in [
        (format!("{translation}/rate"), 4.0.into(), "not invertible"),
        (
            format!("{translation}/rate"),
            (-1.0).into(),
            "positive and finite",
        ),
        (
            format!("{translation}/rate"),
            serde_json::Value::Null,
            "null",
        ),
        (
            format!("{translation}/centre"),
            vec![0.0].into(),
            "a list of 2 components",
        ),
        (
            format!("{translation}/translation"),
            vec![0.1; 3].into(),
            "a list of 2 components",
        ),
        (
            translation.to_owned(),
            serde_json::json!({}),
            "missing field",
        ),
        (format!("{coupling}/moved"), 2.into(), "cannot be moved"),
        (
            format!("{coupling}/largest_log_scale"),
            11.0.into(),
            "between 0 and 10",
        ),
        (
            format!("{coupling}/bumps/0/rate"),
            0.0.into(),
            "positive and finite",
        ),
        (
            format!("{coupling}/bumps/0/shift"),
            f64::MAX.into(),
            "overflows",
        ),
        (
            format!("{coupling}/bumps/0"),
            serde_json::json!({"center": []}),
            "unknown field",
        ),
        (
            "/layers/0".to_owned(),
            serde_json::json!({"rotation": {}}),
            "unknown variant",
        ),
    ] {
        let error = forged(&pointer, value);
        assert!(error.contains(message), "{pointer}: {error}");
    }
}
