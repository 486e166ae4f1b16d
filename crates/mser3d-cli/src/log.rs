//! What `-v` and `RUST_LOG` show, on stderr.

use tracing_subscriber::Layer;
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::layer::SubscriberExt;

use crate::error::CliError;
use crate::message::Log;

/// Starts logging, if it is asked for.
///
/// `-v` shows the stages and their sizes, `-vv` details such as each component tree. Without it `RUST_LOG`
/// decides, as in `RUST_LOG=debug` or `RUST_LOG=mser3d::regions=debug`; without that there is silence.
pub fn start(verbose: u8) -> Result<(), CliError> {
    let targets = match verbose {
        0 => match std::env::var("RUST_LOG") {
            Ok(text) if !text.is_empty() => text
                .parse::<Targets>()
                .map_err(|e| CliError::Usage(format!("RUST_LOG={text}: {e}; write RUST_LOG=info")))?,
            _ => return Ok(()),
        },
        1 => Targets::new().with_default(LevelFilter::INFO),
        2 => Targets::new().with_default(LevelFilter::DEBUG),
        _ => Targets::new().with_default(LevelFilter::TRACE),
    };
    let lines = tracing_subscriber::fmt::layer()
        .with_writer(Log::new)
        .with_ansi(false)
        .with_timer(tracing_subscriber::fmt::time::uptime());
    let subscriber = tracing_subscriber::registry().with(lines.with_filter(targets));
    // This is the first and only one, so it is accepted.
    let _ = tracing::subscriber::set_global_default(subscriber);
    Ok(())
}

/// Whether anything may be logged; progress bars would be written over it.
pub fn is_on() -> bool {
    LevelFilter::current() > LevelFilter::OFF
}
