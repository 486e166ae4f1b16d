//! Left and right, as tables, pages and the command line say them.

use mser3d::Sidedness;

/// The kind of a body's sidedness, as `regions.json` has it.
pub fn sidedness_kind(sidedness: Sidedness) -> &'static str {
    match sidedness {
        Sidedness::NoTwins => "no-twins",
        Sidedness::Alike { .. } => "alike",
        Sidedness::Sided { .. } => "sided",
    }
}

/// How sure the sides of a body with twins are; none of one without.
pub fn sidedness_certainty(sidedness: Sidedness) -> Option<f64> {
    (sidedness != Sidedness::NoTwins).then(|| sidedness.certainty())
}

/// Whether left and right can be told, as the end of a sentence; none of a body without twins, which has neither.
pub fn left_and_right(sidedness: Sidedness) -> Option<String> {
    match sidedness {
        Sidedness::NoTwins => None,
        Sidedness::Alike { .. } => Some(
            "can't be told: as far as can be seen, the body is the same front and back, or top and bottom"
                .to_owned(),
        ),
        Sidedness::Sided { certainty } => Some(format!("told, with certainty {certainty:.2}")),
    }
}

/// A side with its sign, to two digits; the middle has none.
pub fn side_text(side: f64) -> String {
    let rounded = (100.0 * side).round() / 100.0;
    if rounded == 0.0 { "0.00".to_owned() } else { format!("{rounded:+.2}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_those_of_json() {
        let alike = Sidedness::Alike { certainty: 0.25 };
        let sided = Sidedness::Sided { certainty: 0.75 };
        for (sidedness, certainty) in [(Sidedness::NoTwins, None), (alike, Some(0.25)), (sided, Some(0.75))] {
            let json = serde_json::to_value(sidedness).unwrap();
            assert_eq!(json["kind"], sidedness_kind(sidedness));
            assert_eq!(sidedness_certainty(sidedness), certainty);
            assert_eq!(json.get("certainty").and_then(serde_json::Value::as_f64), certainty);
        }
    }

    #[test]
    fn the_middle_has_no_sign() {
        assert_eq!([1.0, -0.976, -0.001, 0.0].map(side_text), ["+1.00", "-0.98", "0.00", "0.00"]);
    }
}
