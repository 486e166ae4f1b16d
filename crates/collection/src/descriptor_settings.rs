use mser3d::spectral::EigenpairRange;
use mser3d::{Descriptor, Domain};
use mser3d_results::Record;
use serde::{Deserialize, Serialize};

/// What two descriptors must have in common for their distance to mean anything.
///
/// A truncated spectrum shifts descriptors (changing 200 eigenpairs to 100 moves SI-vHKS by 18 %), and
/// the time samples define what is measured at all.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DescriptorSettings {
    /// Volume or surface.
    pub domain: Domain,
    /// Which eigenpairs were used: how many, or all below a bound.
    pub eigenpairs: EigenpairRange,
    /// Kind and parameters of the descriptor.
    pub descriptor: Descriptor,
    /// The volume or area that scales time, in the units of the shape.
    pub measure: f64,
    /// Whether that is the shape's own, not a given reference.
    pub own_measure: bool,
}

impl DescriptorSettings {
    /// The settings that a result was made with.
    pub fn of(record: &Record) -> Self {
        let parameters = &record.parameters;
        Self {
            domain: record.domain,
            eigenpairs: match parameters.spectrum.eigenpairs {
                EigenpairRange::LambdaMax(bound) => EigenpairRange::LambdaMax(bound),
                // A small shape has fewer than were asked for.
                _ => EigenpairRange::Count(record.spectrum.eigenpairs),
            },
            descriptor: parameters.descriptor.clone(),
            // Of a shape without regions the own measure may not be known, nor is it needed.
            measure: parameters.reference_measure.or(record.measure()).unwrap_or(0.0),
            own_measure: parameters.reference_measure.is_none(),
        }
    }

    /// What makes comparing with others meaningless; `None` if nothing does.
    pub fn difference(&self, other: &Self) -> Option<String> {
        let mut differences = Vec::new();
        if self.domain != other.domain {
            differences.push(format!("domain {} against {}", self.domain, other.domain));
        }
        if self.eigenpairs != other.eigenpairs {
            differences.push(different_pairs(self.eigenpairs, other.eigenpairs));
        }
        if self.descriptor.kind() != other.descriptor.kind() {
            let (a, b) = (self.descriptor.kind(), other.descriptor.kind());
            differences.push(format!("--descriptor {a} against {b}"));
        } else if self.descriptor != other.descriptor {
            differences.push(format!("descriptor {:?} against {:?}", self.descriptor, other.descriptor));
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

/// Different eigenpairs, as the options that give them.
fn different_pairs(a: EigenpairRange, b: EigenpairRange) -> String {
    use EigenpairRange::{Count, LambdaMax};
    let option = |range| match range {
        LambdaMax(bound) => format!("--lambda-max {bound}"),
        Count(count) => format!("--eigenpairs {count}"),
        other => format!("{other:?}"),
    };
    match (a, b) {
        (Count(a), Count(b)) => format!("--eigenpairs {a} against {b}"),
        (LambdaMax(a), LambdaMax(b)) => format!("--lambda-max {a} against {b}"),
        (a, b) => format!("{} against {}", option(a), option(b)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mser3d::DescriptorKind;

    fn settings(
        eigenpairs: usize,
        kind: DescriptorKind,
        measure: f64,
        own_measure: bool,
    ) -> DescriptorSettings {
        DescriptorSettings {
            domain: Domain::Volume,
            eigenpairs: eigenpairs.into(),
            descriptor: kind.into(),
            measure,
            own_measure,
        }
    }

    #[test]
    fn only_equal_settings_are_comparable_and_the_difference_is_named() {
        let ours = settings(100, DescriptorKind::SiHks, 5.0, true);
        assert_eq!(ours.difference(&settings(100, DescriptorKind::SiHks, 2.0, false)), None);
        let difference = ours.difference(&settings(60, DescriptorKind::Hks, 5.0, true)).unwrap();
        assert_eq!(difference, "--eigenpairs 100 against 60, --descriptor si-hks against hks");
        let bounded = DescriptorSettings { eigenpairs: EigenpairRange::LambdaMax(40.0), ..ours.clone() };
        assert!(ours.difference(&bounded).unwrap().contains("--eigenpairs 100 against --lambda-max 40"));
    }

    #[test]
    fn one_pose_scaled_by_another_is_no_reason_for_caution() {
        let ours = settings(100, DescriptorKind::SiHks, 5.0, true);
        assert_eq!(ours.caution(&settings(100, DescriptorKind::SiHks, 5.0 + 1e-13, false)), None);
        assert_eq!(ours.caution(&settings(100, DescriptorKind::SiHks, 2.0, true)), None);
        assert!(
            ours.caution(&settings(100, DescriptorKind::SiHks, 2.0, false)).unwrap().contains("(5 and 2)")
        );
    }
}
