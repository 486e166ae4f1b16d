//! The command `mser3d`.

fn main() -> std::process::ExitCode {
    mser3d_cli::main(std::env::args_os()).into()
}
