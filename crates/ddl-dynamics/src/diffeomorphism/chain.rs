//! Diffeomorphisms one after the other.

use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Serialize};

use super::{AffineCoupling, Diffeomorphism, LocalTranslation};
use crate::real::Real;

/// One map of a [`Chain`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(
    rename_all = "kebab-case",
    bound(
        serialize = "T: Real + Serialize",
        deserialize = "T: Real + Deserialize<'de>"
    )
)]
#[non_exhaustive]
pub enum Layer<T, const D: usize> {
    /// A translation of the neighbourhood of one point.
    LocalTranslation(LocalTranslation<T, D>),
    /// One coordinate scaled and shifted by amounts that depend on the others.
    AffineCoupling(AffineCoupling<T, D>),
}

impl<T: Real, const D: usize> Layer<T, D> {
    /// A positive number below which `det J` is nowhere (no unit).
    pub fn determinant_lower_bound(&self) -> T {
        match self {
            Self::LocalTranslation(map) => map.determinant_lower_bound(),
            Self::AffineCoupling(map) => map.determinant_lower_bound(),
        }
    }

    fn map(&self) -> &dyn Diffeomorphism<T, D> {
        match self {
            Self::LocalTranslation(map) => map,
            Self::AffineCoupling(map) => map,
        }
    }
}

impl<T, const D: usize> From<LocalTranslation<T, D>> for Layer<T, D> {
    fn from(map: LocalTranslation<T, D>) -> Self {
        Self::LocalTranslation(map)
    }
}

impl<T, const D: usize> From<AffineCoupling<T, D>> for Layer<T, D> {
    fn from(map: AffineCoupling<T, D>) -> Self {
        Self::AffineCoupling(map)
    }
}

impl<T: Real, const D: usize> Diffeomorphism<T, D> for Layer<T, D> {
    fn apply(&self, position: &SVector<T, D>) -> SVector<T, D> {
        self.map().apply(position)
    }

    fn inverse(&self, image: &SVector<T, D>) -> SVector<T, D> {
        self.map().inverse(image)
    }

    fn jacobian(&self, position: &SVector<T, D>) -> SMatrix<T, D, D> {
        self.map().jacobian(position)
    }

    fn apply_with_jacobian(&self, position: &SVector<T, D>) -> (SVector<T, D>, SMatrix<T, D, D>) {
        self.map().apply_with_jacobian(position)
    }
}

/// The composition `psi = psi_n o ... o psi_2 o psi_1`; the identity when there is no layer.
///
/// ```text
/// psi^-1 = psi_1^-1 o ... o psi_n^-1,     J = J_n ... J_2 J_1
/// ```
///
/// with `J_i` taken at the image under the layers before it. The layers are an enumeration and not
/// boxed traits, so that a chain can be compared, copied, and written to a file; reading one back
/// checks every layer as its constructor does.
///
/// # Numerics
/// The errors of the layers add up, each magnified by what the layers after it stretch.
///
/// # Examples
/// ```
/// use ddl_dynamics::{AffineCoupling, Chain, CouplingBump, Diffeomorphism, LocalTranslation};
/// use nalgebra::Vector2;
///
/// let push = LocalTranslation::new(Vector2::new(0.0, 1.0), 0.5, Vector2::new(1.0, 0.0))?;
/// let bump = CouplingBump { centre: Vector2::zeros(), rate: 1.0, log_scale: 0.2, shift: 0.5 };
/// let lift = AffineCoupling::new(1, 0.5, vec![bump])?;
/// let chain = Chain::new(vec![push.into(), lift.clone().into()]);
///
/// let x = Vector2::new(0.3, -0.2);
/// assert_eq!(chain.apply(&x), lift.apply(&push.apply(&x)));
/// let text = serde_json::to_string(&chain).unwrap();
/// assert_eq!(serde_json::from_str::<Chain<f64, 2>>(&text).unwrap(), chain);
/// # Ok::<(), ddl_dynamics::DynamicsError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(
    deny_unknown_fields,
    bound(
        serialize = "T: Real + Serialize",
        deserialize = "T: Real + Deserialize<'de>"
    )
)]
pub struct Chain<T, const D: usize> {
    layers: Vec<Layer<T, D>>,
}

impl<T: Real, const D: usize> Chain<T, D> {
    /// The chain of `layers`, the first of which is applied first.
    pub fn new(layers: Vec<Layer<T, D>>) -> Self {
        Self { layers }
    }

    /// The layers, the first of which is applied first.
    pub fn layers(&self) -> &[Layer<T, D>] {
        &self.layers
    }

    /// The natural logarithm of a number below which `det J` is nowhere: the sum over the layers (no
    /// unit). The number itself, of a long chain, may be too small for `T`.
    pub fn log_determinant_lower_bound(&self) -> T {
        self.layers.iter().fold(T::zero(), |sum, layer| {
            sum + layer.determinant_lower_bound().ln()
        })
    }
}

impl<T: Real, const D: usize> Diffeomorphism<T, D> for Chain<T, D> {
    fn apply(&self, position: &SVector<T, D>) -> SVector<T, D> {
        self.layers
            .iter()
            .fold(*position, |point, layer| layer.apply(&point))
    }

    fn inverse(&self, image: &SVector<T, D>) -> SVector<T, D> {
        self.layers
            .iter()
            .rev()
            .fold(*image, |point, layer| layer.inverse(&point))
    }

    fn jacobian(&self, position: &SVector<T, D>) -> SMatrix<T, D, D> {
        self.apply_with_jacobian(position).1
    }

    fn apply_with_jacobian(&self, position: &SVector<T, D>) -> (SVector<T, D>, SMatrix<T, D, D>) {
        let start = (*position, SMatrix::identity());
        self.layers.iter().fold(start, |(point, jacobian), layer| {
            let (image, factor) = layer.apply_with_jacobian(&point);
            (image, factor * jacobian)
        })
    }
}
