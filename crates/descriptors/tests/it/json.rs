//! Parameters as JSON, and how time scales are written.

use mser3d_descriptors::*;
use serde::de::DeserializeOwned;
use serde_json::json;

#[test]
fn time_scales_have_one_spelling() {
    assert_eq!(TimeScale::Relative(0.5).to_string(), "0.5");
    assert_eq!(TimeScale::Absolute(2048.0).to_string(), "t = 2048");
    assert_eq!(serde_json::to_value(TimeScale::Relative(0.5)).unwrap(), json!({"relative": 0.5}));
    assert_eq!(serde_json::to_value(TimeScale::Absolute(2048.0)).unwrap(), json!({"absolute": 2048.0}));
}

#[test]
fn parameters_come_back_from_json() {
    fn check<T: serde::Serialize + DeserializeOwned + PartialEq + std::fmt::Debug>(value: T) {
        let json = serde_json::to_string(&value).unwrap();
        assert_eq!(serde_json::from_str::<T>(&json).unwrap(), value);
    }
    check(HksParameters::default());
    check(SiHksParameters { unit: Some(0.1), ..Default::default() });
    check(IntegralInvariantParameters::default());
    check(VocabularyParameters::default());
    check(MatchParameters { max_ratio: Some(0.9), ..Default::default() });
    let one_to_one = MatchParameters { rule: MatchRule::OneToOne, ..Default::default() };
    assert_eq!(serde_json::to_value(one_to_one).unwrap()["rule"], "one-to-one");
    check(one_to_one);
}
