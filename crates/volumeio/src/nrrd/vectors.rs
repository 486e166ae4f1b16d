//! Vectors in the text of a header.

/// `(1,0,0) none (0,0,2)`.
pub(super) fn vectors(text: &str) -> Option<Vec<Option<Vec<f64>>>> {
    let mut all = Vec::new();
    let mut rest = text.trim();
    while !rest.is_empty() {
        if let Some(after) = rest.strip_prefix("none") {
            all.push(None);
            rest = after.trim_start();
            continue;
        }
        let (inside, after) = rest.strip_prefix('(')?.split_once(')')?;
        let vector = inside.split(',').map(|word| word.trim().parse().ok()).collect::<Option<Vec<f64>>>()?;
        // A vector of NaN is another way to write none.
        all.push(Some(vector).filter(|vector| !vector.iter().any(|x| x.is_nan())));
        rest = after.trim_start();
    }
    Some(all)
}
