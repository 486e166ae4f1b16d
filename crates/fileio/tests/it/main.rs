//! The crate as its users see it.

#[path = "../../examples/arrays_for_numpy.rs"]
mod arrays_for_numpy;

use mser3d_fileio::{
    FileError, NpyArray, NpyValues, ReadLimits, read_bytes, read_npy, read_npz, write_npy, write_text,
};

#[test]
fn the_example_runs() {
    arrays_for_numpy::main().unwrap();
}

#[test]
fn texts_come_back_as_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    write_text(&path, "λ = 0\n").unwrap();
    assert_eq!(read_bytes(&path).unwrap(), "λ = 0\n".as_bytes());
}

#[test]
fn arrays_come_back_with_their_order() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npy");
    let array = NpyArray::new(&[2, 2], vec![1u16, 2, 3, 4]).unwrap();
    write_npy(&path, &array).unwrap();
    let (read, first_axis_fastest) = read_npy(&path, &ReadLimits::default()).unwrap();
    assert_eq!((read, first_axis_fastest), (array, false));
}

#[test]
fn errors_name_the_file_and_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npy");
    assert!(matches!(read_npy(&path, &ReadLimits::default()), Err(FileError::Read { .. })));
    write_text(&path, "no array").unwrap();
    let error = read_npy(&path, &ReadLimits::default()).unwrap_err();
    assert!(matches!(error, FileError::Invalid { .. }));
    assert!(error.to_string().ends_with("a.npy: not a .npy file; save the array with numpy.save"));
    assert!(matches!(read_npz(&path), Err(FileError::Invalid { .. })));
    let error = NpyArray::new(&[2, 2], NpyValues::from(vec![1.0])).unwrap_err();
    assert_eq!(error.to_string(), "array: shape [2, 2] does not fit 1 values");
}
