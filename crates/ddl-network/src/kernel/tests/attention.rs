//! The formula of attention in f64, one query at a time.

/// One query over `keys` and `values`, with weights multiplied by `factors`, and the gradients of Σ `gradient` · mixed.
pub(crate) struct Attention<'a> {
    pub(crate) query: &'a [f64],
    pub(crate) keys: &'a [&'a [f64]],
    pub(crate) values: &'a [&'a [f64]],
    pub(crate) factors: &'a [f64],
}

pub(crate) struct QueryGradients {
    pub(crate) query: Vec<f64>,
    pub(crate) keys: Vec<Vec<f64>>,
    pub(crate) values: Vec<Vec<f64>>,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Attention<'_> {
    fn weights(&self) -> Vec<f64> {
        let scale = 1.0 / (self.query.len() as f64).sqrt();
        let scores = self.keys.iter().map(|key| scale * dot(self.query, key));
        let scores: Vec<f64> = scores.collect();
        let largest = scores.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
        let powers: Vec<f64> = scores.iter().map(|score| (score - largest).exp()).collect();
        let sum: f64 = powers.iter().sum();
        powers.iter().map(|power| power / sum).collect()
    }

    pub(crate) fn mixed(&self) -> Vec<f64> {
        let mut mixed = vec![0.0; self.query.len()];
        for ((weight, factor), value) in self.weights().iter().zip(self.factors).zip(self.values) {
            for (mixed, value) in mixed.iter_mut().zip(*value) {
                *mixed += weight * factor * value;
            }
        }
        mixed
    }

    pub(crate) fn gradients(&self, gradient: &[f64]) -> QueryGradients {
        let weights = self.weights();
        let scale = 1.0 / (self.query.len() as f64).sqrt();
        let of_weights: Vec<f64> = self
            .values
            .iter()
            .zip(self.factors)
            .map(|(value, factor)| factor * dot(gradient, value))
            .collect();
        let mean = dot(&weights, &of_weights);
        let mut result = QueryGradients {
            query: vec![0.0; self.query.len()],
            keys: Vec::new(),
            values: Vec::new(),
        };
        for (j, weight) in weights.iter().enumerate() {
            let of_score = scale * weight * (of_weights[j] - mean);
            for (query, key) in result.query.iter_mut().zip(self.keys[j]) {
                *query += of_score * key;
            }
            result
                .keys
                .push(self.query.iter().map(|query| of_score * query).collect());
            let taken = weight * self.factors[j];
            result
                .values
                .push(gradient.iter().map(|gradient| taken * gradient).collect());
        }
        result
    }
}
