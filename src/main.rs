//! The `occlabel` program; everything it does lives in the `occlabel-cli` crate.

fn main() -> std::process::ExitCode {
    occlabel_cli::main()
}
