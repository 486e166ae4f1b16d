//! Chromium, found or installed, and driven over its DevTools protocol.

mod devtools;

use std::path::PathBuf;

use serde_json::json;

pub use devtools::Browser;

use crate::command::runs;

/// WebGL2 without a graphics card.
pub const SOFTWARE_GL: [&str; 2] = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

/// The browser in `BROWSER`, or the first of the usual names that starts.
pub fn find() -> Option<PathBuf> {
    let named = std::env::var("BROWSER").ok();
    let usual = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome"];
    let mut names = named.into_iter().chain(usual.map(str::to_owned));
    names.find(|name| runs(name, &["--version"])).map(PathBuf::from)
}

/// Installs Chromium where that needs no question: on Debian and its kin, as root.
pub fn install() -> Option<PathBuf> {
    let root = crate::command::output(std::process::Command::new("id").arg("-u"), crate::command::MINUTE);
    if root.ok()?.trim() != "0" || !runs("apt-get", &["--version"]) {
        return None;
    }
    println!("installing chromium");
    let installed =
        runs("apt-get", &["update", "-q"]) && runs("apt-get", &["install", "-y", "-q", "chromium"]);
    if installed { find() } else { None }
}

impl Browser {
    /// A phone's window from now on, with touch.
    pub fn be_a_phone(&mut self) -> Result<(), String> {
        let phone = json!({ "width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": true });
        self.call("Emulation.setDeviceMetricsOverride", phone)?;
        self.call("Emulation.setTouchEmulationEnabled", json!({ "enabled": true })).map(|_| ())
    }
}
