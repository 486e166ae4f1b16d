//! Matching on cases small enough to do by hand.

use mser3d_descriptors::*;

fn points(values: &[f64]) -> Descriptors {
    Descriptors::new(1, values.to_vec()).unwrap()
}

fn pairs(queries: &[f64], references: &[f64], params: &MatchParameters) -> Vec<(usize, usize)> {
    let matches = match_descriptors(&points(queries), &points(references), params).unwrap();
    matches.iter().map(|m| (m.query, m.partner.reference)).collect()
}

#[test]
fn the_three_rules_differ_as_they_should() {
    let (queries, references) = ([0.0, 1.0, 9.0], [1.2, 6.0, 20.0]);
    let by = |rule| pairs(&queries, &references, &MatchParameters { rule, ..Default::default() });
    assert_eq!(by(MatchRule::Nearest), [(0, 0), (1, 0), (2, 1)]);
    assert_eq!(by(MatchRule::Mutual), [(1, 0), (2, 1)]);
    // 0-0, 1-1, 2-2 costs 17.2 and 0-1, 1-0, 2-2 costs 17.2 as well; 0-0, 1-2, 2-1 costs 23.2.
    let assigned = by(MatchRule::OneToOne);
    assert_eq!(assigned.len(), 3);
    let total: f64 = assigned.iter().map(|&(q, r)| (queries[q] - references[r]).abs()).sum();
    assert!((total - 17.2).abs() < 1e-12);
}

#[test]
fn filters_drop_far_and_doubtful_matches() {
    let nearest = MatchParameters::default();
    let (queries, references) = ([0.0, 4.4, 9.0], [0.5, 5.0, 4.0]);
    assert_eq!(pairs(&queries, &references, &nearest), [(0, 0), (1, 2), (2, 1)]);
    let near = MatchParameters { max_distance: Some(0.5), ..nearest };
    assert_eq!(pairs(&queries, &references, &near), [(0, 0), (1, 2)]);
    let sure = MatchParameters { max_ratio: Some(0.6), ..nearest };
    assert_eq!(pairs(&queries, &references, &sure), [(0, 0)]);
}

#[test]
fn symmetric_candidates_are_reported() {
    // Rows: left arm, right arm, head.
    let references = Descriptors::new(2, vec![1.0, 2.0, 1.0, 2.01, 8.0, 1.0]).unwrap();
    let queries = Descriptors::new(2, vec![1.1, 2.1, 8.1, 1.0]).unwrap();
    let matches = match_descriptors(&queries, &references, &MatchParameters::default()).unwrap();
    let [arm, head] = matches[..] else { panic!("{matches:?}") };
    assert!(arm.ambiguous && !head.ambiguous);
    assert_eq!((arm.partner.reference, arm.rival.unwrap().reference), (1, 0));
    assert_eq!(head.partner.reference, 2);
    assert!((head.partner.distance - 0.1).abs() < 1e-12);
}

#[test]
fn equal_references_are_ambiguous_and_the_first_counts() {
    let matches =
        match_descriptors(&points(&[3.0]), &points(&[3.0, 3.0]), &MatchParameters::default()).unwrap();
    assert_eq!((matches[0].partner.reference, matches[0].ambiguous), (0, true));
}

#[test]
fn few_references_or_none_are_no_error() {
    let single =
        match_descriptors(&points(&[1.0, 2.0]), &points(&[5.0]), &MatchParameters::default()).unwrap();
    assert!(single.iter().all(|m| m.rival.is_none() && !m.ambiguous));
    for rule in [MatchRule::Nearest, MatchRule::Mutual, MatchRule::OneToOne] {
        let params = MatchParameters { rule, ..Default::default() };
        assert_eq!(pairs(&[1.0, 2.0], &[], &params), []);
        assert_eq!(pairs(&[], &[1.0], &params), []);
    }
    let one = MatchParameters { rule: MatchRule::OneToOne, ..Default::default() };
    assert_eq!(pairs(&[1.0, 5.1], &[5.0], &one), [(1, 0)]);
}

#[test]
fn wrong_input_is_named() {
    let wide = Descriptors::new(2, vec![1.0, 2.0]).unwrap();
    let error = match_descriptors(&wide, &points(&[1.0]), &MatchParameters::default()).unwrap_err();
    assert_eq!(error.to_string(), "lengths of the descriptors to compare: found 2, expected 1");
    assert!(MatchParameters { max_ratio: Some(1.5), ..Default::default() }.validate().is_err());
    assert!(MatchParameters { ambiguity: 0.0, ..Default::default() }.validate().is_err());
    assert!(MatchParameters { max_distance: Some(f64::NAN), ..Default::default() }.validate().is_err());
    assert_eq!(Descriptors::new(2, vec![0.0, f64::NAN]), Err(DescriptorError::NotFinite { row: 0 }));
    assert!(Descriptors::new(0, vec![]).is_err() && Descriptors::new(2, vec![0.0; 3]).is_err());
}
