//! What records keep of volumes survives JSON.

use mser3d_volumeio::World;

#[test]
fn a_world_comes_back() {
    let world = World { unit: Some("mm".to_owned()), ..World::default() };
    let text = serde_json::to_string(&world).unwrap();
    assert_eq!(text, r#"{"axes":"file","unit":"mm"}"#);
    assert_eq!(serde_json::from_str::<World>(&text).unwrap(), world);
}
