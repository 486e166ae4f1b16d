//! Placements survive JSON.

use mser3d_volumeio::Placement;

#[test]
fn a_placement_comes_back_bit_for_bit() {
    let turned = [[0.1f64.cos(), 0.1f64.sin(), 0.0], [-0.1f64.sin(), 0.1f64.cos(), 0.0], [0.0, 0.0, 1.0]];
    let placement =
        Placement { origin: [-4.5, 0.1, 1e-3], spacing: [0.7, 0.7, 1.0 / 3.0], directions: turned };
    let text = serde_json::to_string(&placement).unwrap();
    assert_eq!(serde_json::from_str::<Placement>(&text).unwrap(), placement);
    assert!(text.starts_with(r#"{"origin":[-4.5,0.1,0.001],"spacing":"#), "{text}");
}
