use std::path::{Path, PathBuf};

use mser3d::shape::{Eigenbasis, Functions, FunctionsView};
use mser3d::spectral::{EigenpairRange, Eigensolver, Spectrum, SpectrumParameters, SpectrumReport};
use mser3d::{DiscreteShape, Elements, ProgressFn};
use mser3d_fileio::{FileError, NpyArray, NpyValues, read_npz, write_npz};
use mser3d_shape::Choice;
use sha2::{Digest, Sha256};

use crate::CollectionError;

/// A folder of spectra, so that none is computed twice.
///
/// A spectrum is kept under a hash of all that it depends on: the grid with its links and frame, or the
/// mesh; the [`SpectrumParameters`] but for the memory limit; and the version of mser3d. Its file is a
/// `.npz` of 8 n k bytes (36 MB for 45,000 voxels and 100 eigenpairs), or half of that where the eigenfunctions are in single
/// precision. It holds every bit, so results are the same with and without the cache. Many processes can share one; files
/// appear as a whole. What is read is checked to be eigenpairs of the shape, whatever the file says.
#[derive(Clone, Debug)]
pub struct SpectrumCache {
    folder: PathBuf,
}

/// How a spectrum came out of a [`SpectrumCache`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CacheUse {
    /// It was there.
    Hit,
    /// It was computed and is there from now on.
    Stored,
    /// Something is wrong with the cache; the spectrum was computed. What the user should know.
    Trouble(String),
}

/// Changes whenever the same parameters would give another spectrum or its file another layout.
const GENERATION: &str = concat!("mser3d spectrum 4, version ", env!("CARGO_PKG_VERSION"));

impl SpectrumCache {
    /// A cache in a folder, which is made if it is not there.
    ///
    /// # Errors
    /// [`CollectionError::Io`].
    pub fn open(folder: &Path) -> Result<Self, CollectionError> {
        std::fs::create_dir_all(folder).map_err(CollectionError::io(folder))?;
        Ok(Self { folder: folder.to_owned() })
    }

    /// The spectrum of a shape, computed only if it is not there.
    ///
    /// # Errors
    /// Those of [`DiscreteShape::spectrum`]; a cache that cannot be read or written is only [`CacheUse::Trouble`].
    pub fn spectrum(
        &self,
        shape: &DiscreteShape,
        parameters: &SpectrumParameters,
        progress: ProgressFn,
    ) -> Result<(Spectrum, CacheUse), mser3d::Error> {
        let key = key(shape, parameters);
        let path = self.path(&key);
        let trouble = match read(&path, &key, shape, parameters) {
            Ok(spectrum) => return Ok((spectrum, CacheUse::Hit)),
            Err(trouble) => trouble,
        };
        let spectrum = shape.spectrum(parameters, progress)?;
        let trouble = trouble.map(|t| format!("{t}; computed again"));
        // What is no file, such as a pipe, stays as it is.
        let written = match path.is_file() || !path.exists() {
            true => write(&path, &key, &spectrum).err().map(|e| e.to_string()),
            false => Some(format!("{}: something is in its place", path.display())),
        };
        let trouble = trouble.or(written.map(|e| format!("the spectrum is not kept: {e}")));
        Ok((spectrum, trouble.map_or(CacheUse::Stored, CacheUse::Trouble)))
    }

    /// The cache as a detector's source of spectra ([`Detector::spectra`](mser3d::Detector::spectra)); `warn` hears
    /// what is wrong with it.
    pub fn source<'a>(
        &'a self,
        warn: impl Fn(&str) + Sync + 'a,
    ) -> impl Fn(&DiscreteShape, &SpectrumParameters, ProgressFn) -> Result<Spectrum, mser3d::Error> + Sync + 'a
    {
        move |shape: &DiscreteShape, parameters: &SpectrumParameters, progress: ProgressFn| {
            let (spectrum, used) = self.spectrum(shape, parameters, progress)?;
            tracing::info!(?used, "asked the cache of spectra");
            if let CacheUse::Trouble(what) = used {
                warn(&what);
            }
            Ok(spectrum)
        }
    }

    fn path(&self, key: &[u8]) -> PathBuf {
        let name: String = key.iter().map(|b| format!("{b:02x}")).collect();
        self.folder.join(format!("{name}.npz"))
    }
}

/// An error of the eigenpairs ([`DiscreteShape::eigenpair_error`]) that no solver makes.
const LARGEST_ERROR: f64 = 1e-4;

/// A hash of all that a spectrum depends on.
fn key(shape: &DiscreteShape, parameters: &SpectrumParameters) -> Vec<u8> {
    let mut hash = Sha256::new();
    hash.update(GENERATION);
    let mut integer = |x: u64| hash.update(x.to_le_bytes());
    match parameters.eigenpairs {
        EigenpairRange::Count(count) | EigenpairRange::AtMost(count) => {
            integer(count.min(shape.len()) as u64);
        }
        EigenpairRange::LambdaMax(bound) => {
            [u64::MAX, bound.to_bits()].into_iter().for_each(&mut integer);
        }
    }
    integer(parameters.tolerance.to_bits());
    integer(parameters.max_iterations as u64);
    integer(match parameters.solver {
        Eigensolver::ShiftInvert => 1,
        Eigensolver::Filter => 2,
        Eigensolver::Multigrid => 4,
        _ => 0,
    });
    match shape.elements() {
        Elements::Voxels { grid, .. } => {
            let frame = grid.frame();
            integer(3);
            frame.dims().into_iter().for_each(|n| integer(n as u64));
            frame.origin().into_iter().chain(frame.spacing()).for_each(|x| integer(x.to_bits()));
            let bits = grid.links().iter().chain([grid.occupancy()]);
            bits.flat_map(|bits| bits.words()).for_each(|&word| integer(word));
        }
        Elements::Vertices { mesh, .. } => {
            integer(2);
            integer(mesh.vertices().len() as u64);
            mesh.vertices().iter().flatten().for_each(|x| integer(x.to_bits()));
            mesh.triangles().iter().flatten().for_each(|&v| integer(v.into()));
        }
    }
    hash.finalize().to_vec()
}

fn write(path: &Path, key: &[u8], spectrum: &Spectrum) -> Result<(), FileError> {
    let basis = &spectrum.basis;
    write_arrays(path, key, &spectrum.report, basis.mass(), basis.eigenvalues(), basis.functions())
}

fn write_arrays(
    path: &Path,
    key: &[u8],
    report: &SpectrumReport,
    mass: &[f64],
    eigenvalues: &[f64],
    functions: FunctionsView<'_>,
) -> Result<(), FileError> {
    let functions = match functions {
        FunctionsView::Double(values) => NpyValues::from(values),
        FunctionsView::Single(values) => values.into(),
    };
    let counts = [report.iterations, report.applications, report.zero_modes].map(|n| n as i64);
    write_npz(
        path,
        &[
            ("key", NpyArray::flat(key)),
            ("solver", NpyArray::flat(report.solver.name().as_bytes())),
            ("counts", NpyArray::flat(counts.to_vec())),
            ("quality", NpyArray::flat(vec![report.residual, report.orthogonality])),
            ("mass", NpyArray::flat(mass)),
            ("eigenvalues", NpyArray::flat(eigenvalues)),
            ("functions", NpyArray::new(&[mass.len(), eigenvalues.len()], functions)?),
        ],
    )
}

/// The spectrum in a file, or what is wrong with it: nothing (`None`) if there is no file.
fn read(
    path: &Path,
    key: &[u8],
    shape: &DiscreteShape,
    parameters: &SpectrumParameters,
) -> Result<Spectrum, Option<String>> {
    if !path.exists() {
        return Err(None);
    }
    let mut arrays = read_npz(path).map_err(|e| Some(e.to_string()))?;
    let mut take = |name: &str| arrays.remove(name).map(NpyArray::into_values);
    let spectrum = (|| {
        let NpyValues::U8(stored_key) = take("key")? else { return None };
        let NpyValues::U8(solver) = take("solver")? else { return None };
        let NpyValues::I64(counts) = take("counts")? else { return None };
        let NpyValues::F64(quality) = take("quality")? else { return None };
        let NpyValues::F64(mass) = take("mass")? else { return None };
        let NpyValues::F64(eigenvalues) = take("eigenvalues")? else { return None };
        let functions = match take("functions")? {
            NpyValues::F64(values) => Functions::Double(values.into_owned()),
            NpyValues::F32(values) => Functions::Single(values.into_owned()),
            _ => return None,
        };
        let solver = std::str::from_utf8(&solver).ok()?.parse().ok()?;
        let (&[iterations, applications, zero_modes], &[residual, orthogonality]) = (&*counts, &*quality)
        else {
            return None;
        };
        if stored_key != key || mass.len() != shape.len() {
            return None;
        }
        let basis =
            Eigenbasis::new(shape.domain(), mass.into_owned(), eigenvalues.into_owned(), functions).ok()?;
        // A file may be whole and hold nonsense all the same.
        let count = |n: i64| usize::try_from(n).ok();
        let asked = match parameters.eigenpairs {
            EigenpairRange::Count(count) | EigenpairRange::AtMost(count) => {
                basis.eigenvalues().len() <= count
            }
            EigenpairRange::LambdaMax(bound) => basis.eigenvalues().last().is_none_or(|&last| last <= bound),
        };
        let error = shape.eigenpair_error(&basis).ok()?;
        if !asked || error > LARGEST_ERROR.max(100.0 * parameters.tolerance) {
            return None;
        }
        let mut report = SpectrumReport::new(solver);
        [report.iterations, report.applications, report.zero_modes] =
            [count(iterations)?, count(applications)?, count(zero_modes)?];
        [report.residual, report.orthogonality] = [residual, orthogonality];
        Some(Spectrum::new(basis, report))
    })();
    spectrum.ok_or_else(|| Some(format!("{}: not the spectrum that its name promises", path.display())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use mser3d::shape::{BitGrid, Connectivity, Frame, VoxelGrid};
    use mser3d::spectral::SolverUsed;

    fn bar(length: usize) -> DiscreteShape {
        let dims = [4, 5, length];
        let frame = Frame::new(dims, [0.0; 3], [0.5; 3]).unwrap();
        DiscreteShape::solid(
            VoxelGrid::solid(frame, BitGrid::full(dims).unwrap()).unwrap(),
            Connectivity::Six,
        )
    }

    fn parameters() -> SpectrumParameters {
        SpectrumParameters { eigenpairs: 8.into(), ..Default::default() }
    }

    fn bits(spectrum: &Spectrum) -> Vec<u64> {
        let basis = &spectrum.basis;
        let numbers =
            basis.mass().iter().chain(basis.eigenvalues()).copied().chain(basis.functions().values());
        numbers.map(f64::to_bits).collect()
    }

    fn ask(
        cache: &SpectrumCache,
        shape: &DiscreteShape,
        parameters: &SpectrumParameters,
    ) -> (Spectrum, CacheUse) {
        cache.spectrum(shape, parameters, mser3d::NO_PROGRESS).unwrap()
    }

    #[test]
    fn a_cached_spectrum_is_the_computed_one_to_the_last_bit_whatever_solved_it() {
        let folder = tempfile::tempdir().unwrap();
        let cache = SpectrumCache::open(&folder.path().join("new")).unwrap();
        let large = SpectrumParameters { solver: Eigensolver::ShiftInvert, ..parameters() };
        let mut solvers = Vec::new();
        for (shape, parameters) in [(bar(10), parameters()), (bar(150), parameters()), (bar(150), large)] {
            let computed = shape.spectrum(&parameters, mser3d::NO_PROGRESS).unwrap();
            for used in [CacheUse::Stored, CacheUse::Hit] {
                let (spectrum, how) = ask(&cache, &shape, &parameters);
                assert_eq!((how, spectrum.report), (used, computed.report));
                assert!(bits(&spectrum) == bits(&computed));
            }
            solvers.push(computed.report.solver);
        }
        assert_eq!(solvers, [SolverUsed::Dense, SolverUsed::Filter, SolverUsed::ShiftInvert]);
    }

    #[test]
    fn what_changes_the_spectrum_changes_the_key() {
        let grid = |shape: &DiscreteShape| shape.grid().unwrap().clone();
        let cut = grid(&bar(20)).with_cut_links(0, &[[1, 1, 1]]).0;
        let bodies = [bar(20), bar(21), DiscreteShape::solid(cut, Connectivity::Six)];
        let other = [
            SpectrumParameters { eigenpairs: 9.into(), ..parameters() },
            SpectrumParameters { eigenpairs: EigenpairRange::LambdaMax(9.0), ..parameters() },
            SpectrumParameters { tolerance: 1e-8, ..parameters() },
            SpectrumParameters { solver: Eigensolver::ShiftInvert, ..parameters() },
        ];
        let keys = bodies.iter().map(|b| key(b, &parameters()));
        let keys: std::collections::HashSet<_> =
            keys.chain(other.iter().map(|p| key(&bodies[0], p))).collect();
        assert_eq!(keys.len(), 7);
        let limited = SpectrumParameters { memory_limit: Some(1 << 40), ..parameters() };
        assert_eq!(key(&bodies[0], &limited), key(&bodies[0], &parameters()));
    }

    #[test]
    fn a_damaged_or_foreign_file_is_ignored_named_and_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let cache = SpectrumCache::open(folder.path()).unwrap();
        let (shape, other) = (bar(20), bar(12));
        let (computed, _) = ask(&cache, &shape, &parameters());
        ask(&cache, &other, &parameters());
        let path = cache.path(&key(&shape, &parameters()));
        let whole = std::fs::read(&path).unwrap();
        let mut flipped = whole.clone();
        flipped[whole.len() / 2] ^= 4;
        let foreign = std::fs::read(cache.path(&key(&other, &parameters()))).unwrap();
        for bad in [&whole[..whole.len() / 2], &flipped, &foreign, b"", b"something else"] {
            std::fs::write(&path, bad).unwrap();
            let (spectrum, how) = ask(&cache, &shape, &parameters());
            assert_eq!(bits(&spectrum), bits(&computed));
            let CacheUse::Trouble(text) = how else { panic!("{} bytes pass", bad.len()) };
            assert!(text.contains(&path.display().to_string()), "{text}");
            assert_eq!(std::fs::read(&path).unwrap(), whole, "written again");
        }
    }

    /// Files that are whole, with the right key, and hold other numbers.
    #[test]
    fn nonsense_with_the_right_key_is_no_spectrum() {
        let folder = tempfile::tempdir().unwrap();
        let cache = SpectrumCache::open(folder.path()).unwrap();
        for parameters in
            [parameters(), SpectrumParameters { eigenpairs: EigenpairRange::LambdaMax(20.0), ..parameters() }]
        {
            let shape = bar(20);
            let (computed, _) = ask(&cache, &shape, &parameters);
            let (key, basis) = (key(&shape, &parameters), &computed.basis);
            let path = cache.path(&key);
            let k = basis.eigenvalues().len();
            let changed = |change: &dyn Fn(&mut Vec<f64>, &mut Vec<f64>, &mut Vec<f64>)| {
                let (mut mass, mut values, mut functions) = (
                    basis.mass().to_vec(),
                    basis.eigenvalues().to_vec(),
                    basis.functions().to_f64().into_owned(),
                );
                change(&mut mass, &mut values, &mut functions);
                let view = FunctionsView::Double(&functions);
                write_arrays(&path, &key, &computed.report, &mass, &values, view).unwrap();
                let (spectrum, how) = ask(&cache, &shape, &parameters);
                assert!(bits(&spectrum) == bits(&computed));
                how
            };
            assert_eq!(changed(&|_, _, _| {}), CacheUse::Hit);
            let nonsense: [&dyn Fn(&mut Vec<f64>, &mut Vec<f64>, &mut Vec<f64>); 9] = [
                &|_, _, functions| functions[k * 7 + 3] = f64::NAN,
                &|_, _, functions| functions[k * 7 + 3] = f64::INFINITY,
                &|_, _, functions| functions[k * 7 + 3] *= 1.01,
                &|_, _, functions| functions.fill(0.0),
                &|_, _, functions| functions.swap(0, k * 399 + 1),
                &|_, values, _| values[k - 1] *= 1.001,
                &|_, values, _| values.fill(0.0),
                &|mass, _, _| mass[5] *= 2.0,
                &|_, values, functions| {
                    // A pair twice: the residual is small, but it is no basis.
                    values[k - 1] = values[k - 2];
                    functions.chunks_mut(k).for_each(|row| row[k - 1] = row[k - 2]);
                },
            ];
            for (number, change) in nonsense.into_iter().enumerate() {
                assert!(matches!(changed(change), CacheUse::Trouble(_)), "{number}");
            }
        }
    }

    #[test]
    fn single_precision_comes_back_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let cache = SpectrumCache::open(folder.path()).unwrap();
        // Of so long a bar the rounding to single precision is as large as the eigenvalues, once the Laplacian is applied to it.
        for length in [20, 4000] {
            let (shape, parameters) =
                (bar(length), SpectrumParameters { eigenpairs: 3.into(), ..parameters() });
            let (computed, _) = ask(&cache, &shape, &parameters);
            let key = key(&shape, &parameters);
            let basis = &computed.basis;
            let functions: Vec<f32> = basis.functions().values().map(|x| x as f32).collect();
            let store = |functions: &[f32]| {
                let (path, view) = (cache.path(&key), FunctionsView::Single(functions));
                write_arrays(&path, &key, &computed.report, basis.mass(), basis.eigenvalues(), view).unwrap();
                ask(&cache, &shape, &parameters)
            };
            let (read, how) = store(&functions);
            assert_eq!(how, CacheUse::Hit, "{length}");
            assert_eq!(read.basis.functions(), FunctionsView::Single(&functions));
            // What is read is written again as it is.
            write(&cache.path(&key), &key, &read).unwrap();
            let (again, how) = ask(&cache, &shape, &parameters);
            assert_eq!((again.basis, how), (read.basis, CacheUse::Hit));

            let mut wrong = functions.clone();
            wrong[3 * 7 + 2] *= 1.01;
            let (read, how) = store(&wrong);
            assert!(matches!(how, CacheUse::Trouble(_)), "{length}");
            assert_eq!(bits(&read), bits(&computed));
        }
    }
}
