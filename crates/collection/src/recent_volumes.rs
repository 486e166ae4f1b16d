use std::sync::{Arc, Mutex, PoisonError};

use mser3d_results::{ResultsError, ShapeFile, VolumeFile};

use crate::Job;

/// The volumes that were read last: the labels of a label map are many shapes of one file.
#[derive(Default)]
pub(crate) struct RecentVolumes(Mutex<Vec<(Job, Arc<VolumeFile>)>>);

impl RecentVolumes {
    /// As many files as are in use at a time, when shapes go by name: the one that ends and the one that begins.
    const KEPT: usize = 2;

    /// Reads a shape.
    pub fn read(&self, job: &Job) -> Result<ShapeFile, ResultsError> {
        if job.options.body.label.is_none() || job.options.volume_format(&job.path).is_none() {
            return job.read();
        }
        self.volume(job)?.shape(&job.options.body)
    }

    fn volume(&self, job: &Job) -> Result<Arc<VolumeFile>, ResultsError> {
        // Locked while it is read, so that others wait for it instead of reading it too.
        let mut recent = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let same = |other: &Job| {
            let (a, b) = (&other.options, &job.options);
            other.path == job.path && (&a.placement, &a.label_names) == (&b.placement, &b.label_names)
        };
        if let Some((_, volume)) = recent.iter().find(|(other, _)| same(other)) {
            return Ok(Arc::clone(volume));
        }
        let volume = Arc::new(VolumeFile::read(&job.path, &job.options)?);
        if recent.len() == Self::KEPT {
            recent.remove(0);
        }
        recent.push((job.clone(), Arc::clone(&volume)));
        Ok(volume)
    }
}
