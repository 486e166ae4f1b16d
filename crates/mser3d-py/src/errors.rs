//! Errors of the libraries as Python's exceptions, with the command line's texts.

use std::error::Error;
use std::io::ErrorKind;

use mser3d::spectral::SpectralError;
use mser3d::voxelize::VoxelizeError;
use mser3d_cli::CliError;
use mser3d_fileio::OverLimit;
use pyo3::PyErr;
use pyo3::exceptions::{
    PyFileNotFoundError, PyKeyboardInterrupt, PyMemoryError, PyOSError, PyPermissionError, PyTimeoutError,
    PyValueError,
};

/// The exception of an error: `OSError` where the operating system refused, `MemoryError` for work that would not fit,
/// `TimeoutError` for work that was not done in time, `KeyboardInterrupt` where it was cancelled, else `ValueError`.
pub fn exception(error: CliError) -> PyErr {
    let text = error.to_string();
    if let CliError::Interrupted | CliError::Collection(mser3d_collection::CollectionError::Cancelled) = error
    {
        return PyKeyboardInterrupt::new_err(());
    }
    if let CliError::TimeLimit { .. } = error {
        return PyTimeoutError::new_err(text);
    }
    let mut cause: Option<&(dyn Error + 'static)> = Some(&error);
    while let Some(error) = cause {
        if let Some(refused) = error.downcast_ref::<std::io::Error>() {
            return match refused.kind() {
                ErrorKind::NotFound => PyFileNotFoundError::new_err(text),
                ErrorKind::PermissionDenied => PyPermissionError::new_err(text),
                // What a decoder says of damaged data.
                ErrorKind::InvalidData | ErrorKind::InvalidInput | ErrorKind::UnexpectedEof => {
                    PyValueError::new_err(text)
                }
                ErrorKind::OutOfMemory => PyMemoryError::new_err(text),
                _ => PyOSError::new_err(text),
            };
        }
        if is_of_memory(error) {
            return PyMemoryError::new_err(text);
        }
        cause = error.source();
    }
    PyValueError::new_err(text)
}

/// Whether an error, or the one that it passes on, says that the work does not fit into memory.
fn is_of_memory(error: &(dyn Error + 'static)) -> bool {
    let spectral = |e: &SpectralError| matches!(e, SpectralError::TooMuchMemory { .. });
    let voxelize = |e: &VoxelizeError| matches!(e, VoxelizeError::TooLarge { .. });
    if let Some(CliError::MemoryLimit { .. }) = error.downcast_ref() {
        return true;
    }
    if error.downcast_ref::<OverLimit>().is_some() {
        return true;
    }
    if let Some(CliError::Shape { source, .. }) = error.downcast_ref::<CliError>() {
        return is_of_memory(source);
    }
    match error.downcast_ref::<mser3d::Error>() {
        Some(mser3d::Error::TooMuchMemory { .. }) => true,
        Some(mser3d::Error::Spectral(e)) => spectral(e),
        Some(mser3d::Error::Voxelize(e)) => voxelize(e),
        _ => error.downcast_ref().is_some_and(spectral) || error.downcast_ref().is_some_and(voxelize),
    }
}

/// An error of the libraries that has no file.
pub fn of_library(error: impl Into<mser3d::Error>) -> CliError {
    match error.into() {
        mser3d::Error::Cancelled | mser3d::Error::Spectral(SpectralError::Cancelled) => CliError::Interrupted,
        error => CliError::Usage(error.to_string()),
    }
}

/// An error in the arguments.
pub fn usage(error: impl ToString) -> CliError {
    CliError::Usage(error.to_string())
}
