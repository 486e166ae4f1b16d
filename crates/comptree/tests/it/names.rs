//! Names of choices, and parameters and reports as JSON.
use mser3d_comptree::shape::Choice;
use mser3d_comptree::{
    AltitudeScale, ComponentTree, MsvParameters, Polarity, PoolParameters, SelectionReport,
    StabilityParameters, StabilityRule, TreeError, stable_regions,
};

fn names<T: Choice>() -> Vec<&'static str> {
    T::ALL.iter().map(|value| value.name()).collect()
}

#[test]
fn choices_have_their_names() {
    assert_eq!(names::<StabilityRule>(), ["windowed", "paper", "baseline"]);
    assert_eq!(names::<AltitudeScale>(), ["log", "linear"]);
    assert_eq!(names::<Polarity>(), ["sublevel", "superlevel"]);
    assert_eq!("paper".parse(), Ok(StabilityRule::Paper));
}

#[test]
fn parameters_and_reports_come_back_from_json() {
    let parameters =
        StabilityParameters { rule: StabilityRule::Paper, min_stability: Some(0.1), ..Default::default() };
    let json = serde_json::to_value(parameters).unwrap();
    assert_eq!(
        (&json["rule"], &json["altitude"], &json["window"]),
        (&"paper".into(), &"log".into(), &0.25.into())
    );
    assert_eq!(serde_json::from_value::<StabilityParameters>(json).unwrap(), parameters);

    let pool = PoolParameters { duplicate_overlap: 0.7 };
    let json = serde_json::to_string(&pool).unwrap();
    assert_eq!(serde_json::from_str::<PoolParameters>(&json).unwrap(), pool);

    let tree = ComponentTree::from_vertex_weights(&[[0, 1]], &[1.0, 2.0], 1.0, Polarity::Sublevel).unwrap();
    let report = stable_regions(&tree, &parameters).unwrap().report;
    let json = serde_json::to_string(&report).unwrap();
    assert_eq!(serde_json::from_str::<SelectionReport>(&json).unwrap(), report);
}

#[test]
fn an_infinite_step_is_null_in_json() {
    for step in [1.0, f64::INFINITY] {
        let parameters = MsvParameters { step, ..Default::default() };
        let json = serde_json::to_value(parameters).unwrap();
        assert_eq!(json["step"].is_null(), step.is_infinite());
        assert_eq!(serde_json::from_value::<MsvParameters>(json).unwrap(), parameters);
    }
}

#[test]
fn the_smallest_volume_may_not_exceed_the_largest() {
    let parameters =
        StabilityParameters { min_volume_fraction: 0.5, max_volume_fraction: 0.4, ..Default::default() };
    let error = parameters.validate().unwrap_err();
    assert!(matches!(&error, TreeError::InvalidParameter(invalid) if invalid.name == "min_volume_fraction"));
    let expected = "min_volume_fraction is 0.5: it must be at most max_volume_fraction (0.4)";
    assert!(error.to_string().starts_with(expected), "{error}");
}
