//! What is written down with a result: names of solvers, parameters and reports.

use mser3d_shape::Choice;
use mser3d_spectral::{Eigensolver, SolverUsed};

#[test]
fn each_solver_has_one_name() {
    let names: Vec<&str> = Eigensolver::ALL.iter().map(|solver| solver.name()).collect();
    assert_eq!(names, ["auto", "shift-invert", "filter", "multigrid"]);
    // Those that can be asked for are called the same when they were used.
    for solver in &Eigensolver::ALL[1..] {
        assert!(solver.name().parse::<SolverUsed>().is_ok(), "{solver}");
    }
}

#[cfg(feature = "serde")]
#[test]
fn parameters_and_reports_keep_every_bit_as_json() {
    use mser3d_spectral::{EigenpairRange, SpectrumParameters, SpectrumReport};
    let parameters = SpectrumParameters {
        eigenpairs: EigenpairRange::LambdaMax(30.0),
        tolerance: 1e-9,
        memory_limit: Some(1 << 30),
        ..Default::default()
    };
    let text = serde_json::to_string(&parameters).unwrap();
    assert_eq!(
        text,
        r#"{"eigenpairs":{"lambda_max":30.0},"tolerance":1e-9,"solver":"auto","max_iterations":60}"#
    );
    let read: SpectrumParameters = serde_json::from_str(&text).unwrap();
    // The memory limit belongs to the machine, not to the result.
    assert_eq!(read, SpectrumParameters { memory_limit: None, ..parameters });
    assert_eq!(serde_json::to_string(&EigenpairRange::Count(100)).unwrap(), r#"{"count":100}"#);

    let mut report = SpectrumReport::new(SolverUsed::ShiftInvert);
    (report.residual, report.zero_modes) = (2.5e-10, 3);
    let text = serde_json::to_string(&report).unwrap();
    assert!(text.starts_with(r#"{"solver":"shift-invert","iterations":0,"#), "{text}");
    assert_eq!(serde_json::from_str::<SpectrumReport>(&text).unwrap(), report);
}
