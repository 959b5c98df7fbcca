//! Statistical tests of dropout decisions.

/// Decisions in rows and columns, scaled to a mean of 0 and a variance of 1.
pub(crate) struct Decided {
    values: Vec<f64>,
    columns: usize,
}

impl Decided {
    /// Decisions with the probability `p` of being dropped.
    pub(crate) fn new(p: f64, [rows, columns]: [usize; 2], dropped: impl Fn(usize, usize) -> bool) -> Self {
        let deviation = (p * (1.0 - p)).sqrt();
        let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        let value = |(row, column)| (f64::from(u8::from(dropped(row, column))) - p) / deviation;
        Self { values: places.map(value).collect(), columns }
    }

    /// The share is right in total, in every row and in every column, and neighbours are uncorrelated.
    pub(crate) fn assert_like_chance(&self) {
        let (values, columns) = (&self.values, self.columns);
        let score = |values: &mut dyn ExactSizeIterator<Item = &f64>| {
            let count = values.len() as f64;
            values.sum::<f64>() / count.sqrt()
        };
        let total = score(&mut values.iter());
        assert!(total.abs() < 4.5, "{total} standard errors over all");
        let of_rows = values.chunks(columns).map(|row| score(&mut row.iter()));
        let of_columns = (0..columns).map(|first| score(&mut values[first..].iter().step_by(columns)));
        let scores: Vec<f64> = of_rows.chain(of_columns).collect();
        assert!(scores.iter().all(|score| score.abs() < 5.5), "{scores:?}");
        // Their variance is that of independent decisions: the mean square is 1 within 5 standard errors.
        let mean = scores.iter().map(|score| score * score).sum::<f64>() / scores.len() as f64;
        let error = (2.0 / scores.len() as f64).sqrt();
        assert!((mean - 1.0).abs() < 5.0 * error, "{mean}");
        let along = (1..=33).chain([64, columns - 16, columns - 1, columns + 1, columns + 16]);
        for shift in along.chain((1..=9).map(|rows| rows * columns)) {
            assert_uncorrelated(&format!("shift {shift}"), values, &values[shift..]);
        }
    }

    /// The decisions of both are uncorrelated, also with an offset of some rows.
    pub(crate) fn assert_apart_from(&self, name: &str, other: &Self) {
        for rows in 0..4 {
            let later = &other.values[rows * self.columns..];
            assert_uncorrelated(&format!("{name}, {rows} rows"), &self.values, later);
        }
    }
}

/// The mean of products is normal with the standard error 1 / sqrt(count), so that more than 5 standard errors are
/// rare.
fn assert_uncorrelated(name: &str, a: &[f64], b: &[f64]) {
    let products = a.iter().zip(b).map(|(a, b)| a * b);
    let count = a.len().min(b.len()) as f64;
    let score = products.sum::<f64>() / count.sqrt();
    assert!(score.abs() < 5.0, "{name}: {score} standard errors");
}
