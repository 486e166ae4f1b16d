use std::path::Path;

use mser3d_results::Record;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::CollectionError;

/// What two descriptors must have in common for their distance to mean anything.
///
/// A truncated spectrum shifts descriptors (changing 200 eigenpairs to 100 moves SI-vHKS by 18 %), and
/// the time samples define what is measured at all.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DescriptorSettings {
    /// Volume or surface.
    pub domain: String,
    /// Eigenpairs that were used; 0 where a bound of the eigenvalues, among the descriptor's parameters, decides.
    pub eigenpairs: u64,
    /// Kind and parameters of the descriptor, as in `regions.json`.
    pub descriptor: Map<String, Value>,
    /// The volume or area that scales time, in the units of the shape.
    pub measure: f64,
    /// Whether that is the shape's own, not a given reference.
    pub own_measure: bool,
}

impl DescriptorSettings {
    /// The settings that a result was made with.
    ///
    /// # Errors
    /// [`CollectionError::Incomplete`] when it does not tell.
    pub fn of(record: &Record, folder: &Path) -> Result<Self, CollectionError> {
        let parameters = record.more.get("parameters").unwrap_or(&Value::Null);
        // A small shape has fewer than were asked for.
        let spectrum = record.more.get("spectrum").unwrap_or(&parameters["spectrum"]);
        let found = spectrum["eigenpairs"].as_u64().zip(parameters["descriptor"].as_object());
        let Some((eigenpairs, descriptor)) = found else {
            let what = "regions.json does not tell how the descriptors were made".to_owned();
            return Err(CollectionError::Incomplete { folder: folder.to_owned(), what });
        };
        let (mut eigenpairs, mut descriptor) = (eigenpairs, descriptor.clone());
        if let Some(bound) = parameters["spectrum"].get("lambda_max").filter(|bound| !bound.is_null()) {
            eigenpairs = 0;
            descriptor.insert("lambda_max".to_owned(), bound.clone());
        }
        // Of a shape without regions the own measure is not known, nor is it needed.
        let own = record.regions.first().map_or(0.0, |r| r.volume / r.volume_fraction);
        let reference = parameters["reference_measure"].as_f64();
        Ok(Self {
            domain: match record.domain {
                mser3d::Domain::Volume => "volume",
                mser3d::Domain::Surface => "surface",
            }
            .to_owned(),
            eigenpairs,
            descriptor,
            measure: reference.unwrap_or(own),
            own_measure: reference.is_none(),
        })
    }

    /// What makes comparing with others meaningless; `None` if nothing does.
    pub fn difference(&self, other: &Self) -> Option<String> {
        let mut differences = Vec::new();
        let mut compare = |name: &str, a: String, b: String| {
            if a != b {
                differences.push(format!("{name} {a} against {b}"));
            }
        };
        compare("domain", self.domain.clone(), other.domain.clone());
        compare("--eigenpairs", self.eigenpairs.to_string(), other.eigenpairs.to_string());
        let keys = self
            .descriptor
            .keys()
            .chain(other.descriptor.keys().filter(|k| !self.descriptor.contains_key(*k)));
        for key in keys {
            let value = |of: &Self| of.descriptor.get(key).map_or("none".to_owned(), Value::to_string);
            compare(&format!("descriptor {key}"), value(self), value(other));
        }
        (!differences.is_empty()).then(|| differences.join(", "))
    }

    /// What makes comparing with others less certain.
    pub fn caution(&self, other: &Self) -> Option<String> {
        let scaled_alike = (self.measure - other.measure).abs() <= 1e-9 * self.measure;
        let each_its_own = self.own_measure && other.own_measure;
        (!scaled_alike && !each_its_own).then(|| {
            format!(
                "times are scaled by different measures ({} and {}); poses of one body match better when all \
                 have the same --reference-measure, shapes of different size when none has any",
                self.measure, other.measure
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(eigenpairs: u64, kind: &str, measure: f64, own_measure: bool) -> DescriptorSettings {
        let descriptor = Map::from_iter([("kind".to_owned(), Value::from(kind))]);
        DescriptorSettings { domain: "volume".into(), eigenpairs, descriptor, measure, own_measure }
    }

    #[test]
    fn only_equal_settings_are_comparable_and_the_difference_is_named() {
        let ours = settings(100, "si-hks", 5.0, true);
        assert_eq!(ours.difference(&settings(100, "si-hks", 2.0, false)), None);
        let difference = ours.difference(&settings(60, "hks", 5.0, true)).unwrap();
        assert_eq!(difference, "--eigenpairs 100 against 60, descriptor kind \"si-hks\" against \"hks\"");
    }

    #[test]
    fn one_pose_scaled_by_another_is_no_reason_for_caution() {
        let ours = settings(100, "si-hks", 5.0, true);
        assert_eq!(ours.caution(&settings(100, "si-hks", 5.0 + 1e-13, false)), None);
        assert_eq!(ours.caution(&settings(100, "si-hks", 2.0, true)), None);
        assert!(ours.caution(&settings(100, "si-hks", 2.0, false)).unwrap().contains("(5 and 2)"));
    }
}
