//! What `mser3d --version` says.

use std::sync::LazyLock;

/// The version, and what this program was built from.
pub fn long() -> &'static str {
    static TEXT: LazyLock<String> = LazyLock::new(text);
    &TEXT
}

fn text() -> String {
    let known = |value: &'static str| if value.is_empty() { "unknown" } else { value };
    format!(
        "{}\ncommit   {}\ntarget   {}\nprofile  {}\ncompiler {}\nSIMD     {}, chosen at run time",
        env!("CARGO_PKG_VERSION"),
        known(env!("MSER3D_COMMIT")),
        env!("MSER3D_TARGET"),
        env!("MSER3D_PROFILE"),
        known(env!("MSER3D_RUSTC")),
        simd(),
    )
}

/// The instruction set that the kernels choose at run time.
fn simd() -> String {
    let arch = format!("{:?}", pulp::Arch::new());
    let name = arch.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
    match name {
        "V3" => "x86-64-v3 (AVX2)".to_owned(),
        "V4" => "x86-64-v4 (AVX-512)".to_owned(),
        other => other.to_lowercase(),
    }
}
