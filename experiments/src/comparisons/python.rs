//! The Python that other people's libraries run in.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// Which Python to use.
#[derive(clap::Args)]
pub struct PythonArguments {
    /// Set up the peers first: Python's in target/peers, and what others are compiled with by apt-get, as root
    #[arg(long)]
    install: bool,
    /// Python to use [default: the one of --install, else python3]
    #[arg(long)]
    python: Option<PathBuf>,
}

impl PythonArguments {
    /// Installs packages of Debian and its kin, if asked to and where that needs no question. Without them peers are missing, which
    /// is said with what to do.
    pub fn install_libraries(&self, names: &[&str]) {
        let succeeds = |program: &str, arguments: &[&str]| {
            let output = Command::new(program).args(arguments).output();
            output.ok().filter(|output| output.status.success()).map(|output| output.stdout)
        };
        if !self.install || succeeds("dpkg", &[&["--status"], names].concat()).is_some() {
            return;
        }
        if succeeds("id", &["-u"]).is_some_and(|user| user == b"0\n") {
            println!("installing {}", names.join(", "));
            let _ = succeeds("apt-get", &["update", "-q"]);
            let _ = succeeds("apt-get", &[&["install", "-y", "-q"], names].concat());
        }
    }
}

/// An interpreter, and the folder where peers and what is exchanged with them lie.
#[derive(Clone)]
pub struct Python {
    pub folder: PathBuf,
    program: PathBuf,
}

impl Python {
    /// The one that is named, else that of the environment in `target/peers`, else `python3`. `--install` makes
    /// the environment first, with these packages: in each list the first entry that can be installed.
    pub fn find(arguments: &PythonArguments, packages: &[&[&str]]) -> Result<Self, Box<dyn Error>> {
        let target = std::env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
        let target = target.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../target"));
        let folder = target.join("peers");
        std::fs::create_dir_all(&folder)?;
        let environment = folder.join("venv");
        let program = match &arguments.python {
            Some(program) => program.clone(),
            None if arguments.install || environment.exists() => environment.join("bin/python"),
            None => "python3".into(),
        };
        if arguments.install {
            set_up(&environment, packages)?;
        }
        Ok(Self { folder, program })
    }

    /// Runs a script of `experiments/peers`.
    pub fn script(&self, name: &str) -> Command {
        let mut command = Command::new(&self.program);
        command.arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("peers").join(name));
        command
    }

    /// What a script says is there; null where Python itself is not.
    pub fn probe(&self, name: &str) -> Value {
        let output = self.script(name).arg("probe").output();
        output.ok().and_then(|output| serde_json::from_slice(&output.stdout).ok()).unwrap_or_default()
    }
}

fn set_up(environment: &Path, packages: &[&[&str]]) -> Result<(), Box<dyn Error>> {
    let run = |program: &Path, arguments: &[&str]| -> Result<bool, Box<dyn Error>> {
        Ok(Command::new(program).args(arguments).status()?.success())
    };
    if !environment.exists() {
        let folder = environment.to_str().ok_or("the target folder's name is not Unicode")?;
        if !run(Path::new("python3"), &["-m", "venv", folder])? {
            return Err("python3 -m venv failed; apt-get install python3-venv".into());
        }
    }
    let pip = environment.join("bin/pip");
    for choices in packages {
        for choice in *choices {
            if run(&pip, &["install", "--quiet", choice])? {
                break;
            }
        }
    }
    Ok(())
}

/// The last line of a program's output as JSON.
pub fn answer(command: &mut Command) -> Result<Value, Box<dyn Error>> {
    let output = command.output()?;
    if !output.status.success() {
        let text = String::from_utf8_lossy(&output.stderr);
        return Err(text.lines().next_back().unwrap_or("no message").into());
    }
    let text = String::from_utf8_lossy(&output.stdout);
    Ok(serde_json::from_str(text.lines().next_back().unwrap_or_default())?)
}
