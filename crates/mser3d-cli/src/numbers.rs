//! Numbers as values of options, with their ranges.

/// A whole number that is at least one.
pub fn count(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(0) => Err("must be at least 1".into()),
        Ok(n) => Ok(n),
        Err(_) => Err("not a whole number of at least 1".into()),
    }
}

/// A number greater than zero.
pub fn positive(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number")?;
    (value.is_finite() && value > 0.0).then_some(value).ok_or("must be positive and finite".into())
}

/// A number that is not below zero.
pub fn zero_or_more(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number")?;
    (value.is_finite() && value >= 0.0).then_some(value).ok_or("must be finite and 0 or more".into())
}

/// A number from 0 to 1.
pub fn fraction(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number")?;
    (0.0..=1.0).contains(&value).then_some(value).ok_or("must be between 0 and 1".into())
}
