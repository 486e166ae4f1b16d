//! What the operating system knows of memory: what this process has, and what it can still have.

use std::io::Read;
use std::path::{Path, PathBuf};

/// The most memory that this process has held, in bytes; `None` where the system does not tell, as all but Linux.
pub fn peak_memory() -> Option<u64> {
    proc_field(Path::new("/proc/self/status"), "VmHWM:")
}

/// The memory that this process holds, in bytes; `None` where the system does not tell, as all but Linux.
pub fn used_memory() -> Option<u64> {
    proc_field(Path::new("/proc/self/status"), "VmRSS:")
}

/// Memory that this process can have besides what it holds, without swapping, in bytes; `None` where the system does not
/// tell.
///
/// It is the least of what the machine has free and, on Linux, of what is left below each limit: those of the control groups
/// that the process is in (`memory.max` of version 2, `memory.limit_in_bytes` of version 1, with those of the groups around
/// them), as containers and job schedulers set them, and that of its addresses (`ulimit -v`).
pub fn available_memory() -> Option<u64> {
    let root = Path::new("/");
    [free_memory(), control_groups(root), address_space(root)].into_iter().flatten().min()
}

/// What the machine has free.
#[cfg(any(target_os = "macos", windows))]
fn free_memory() -> Option<u64> {
    let mut system = sysinfo::System::new();
    system.refresh_memory();
    Some(system.available_memory()).filter(|&bytes| bytes > 0)
}

/// What the machine has free.
#[cfg(not(any(target_os = "macos", windows)))]
fn free_memory() -> Option<u64> {
    proc_field(Path::new("/proc/meminfo"), "MemAvailable:")
}

/// What is left of the addresses that the process may have. `root` is that of the file system.
fn address_space(root: &Path) -> Option<u64> {
    let limits = std::fs::read_to_string(root.join("proc/self/limits")).ok()?;
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    // The soft limit comes first; without one it is the word "unlimited".
    let most: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(most.saturating_sub(proc_field(&root.join("proc/self/status"), "VmSize:")?))
}

/// What is left in the control groups of the process and those around them. `root` is that of the file system.
fn control_groups(root: &Path) -> Option<u64> {
    let read = |file: &str| std::fs::read_to_string(root.join(file)).ok();
    let groups = read("proc/self/cgroup")?;
    let mounts = read("proc/self/mountinfo")?;
    let mut least: Option<u64> = None;
    for hierarchy in mounts.lines().filter_map(Hierarchy::of) {
        // `4:memory:/path` of version 1, where several controllers may share a hierarchy, and `0::/path` of version 2.
        let own = groups.lines().find_map(|line| {
            let (controllers, path) = line.split_once(':')?.1.split_once(':')?;
            let is_it = match hierarchy.version {
                Version::One => controllers.split(',').any(|name| name == "memory"),
                Version::Two => controllers.is_empty(),
            };
            is_it.then_some(path)
        });
        let Some(own) = own.map(Path::new) else { continue };
        // In a container the mount shows a part of the tree; a path outside of it is seen from its top.
        let inside = own.strip_prefix(&hierarchy.shows).unwrap_or(Path::new(""));
        let mount = root.join(hierarchy.mount.strip_prefix("/").unwrap_or(&hierarchy.mount));
        for group in inside.ancestors() {
            let left = hierarchy.version.left(&mount.join(group.strip_prefix("/").unwrap_or(group)));
            least = [least, left].into_iter().flatten().min();
        }
    }
    least
}

#[derive(Clone, Copy)]
enum Version {
    One,
    Two,
}

impl Version {
    /// What is left in one group; `None` for a group without a limit.
    fn left(self, group: &Path) -> Option<u64> {
        let (limit, usage, inactive) = match self {
            Self::One => ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"),
            Self::Two => ("memory.max", "memory.current", "inactive_file"),
        };
        let number = |file: &str| std::fs::read_to_string(group.join(file)).ok()?.trim().parse::<u64>().ok();
        // Without a limit it is the word "max", or of version 1 a number close to 2^63.
        let limit = number(limit).filter(|&bytes| bytes < 1 << 60)?;
        let stat = std::fs::read_to_string(group.join("memory.stat")).unwrap_or_default();
        let field = |line: &str| line.strip_prefix(inactive)?.trim().parse::<u64>().ok();
        // Files in the cache that nobody uses give way.
        let given_way = stat.lines().find_map(field).unwrap_or(0);
        Some(limit.saturating_sub(number(usage)?.saturating_sub(given_way)))
    }
}

/// A tree of control groups that can be seen.
struct Hierarchy {
    version: Version,
    mount: PathBuf,
    /// The group that is at the mount.
    shows: PathBuf,
}

impl Hierarchy {
    /// A line of `/proc/self/mountinfo`: number, parent, device, what is shown, where, options, and behind a dash the file
    /// system, the source and its options.
    fn of(line: &str) -> Option<Self> {
        let (before, after) = line.split_once(" - ")?;
        let mut before = before.split(' ').skip(3).map(|path| PathBuf::from(path.replace("\\040", " ")));
        let (shows, mount) = (before.next()?, before.next()?);
        let mut after = after.split(' ');
        let version = match after.next()? {
            "cgroup2" => Version::Two,
            "cgroup" if after.nth(1)?.split(',').any(|option| option == "memory") => Version::One,
            _ => return None,
        };
        Some(Self { version, mount, shows })
    }
}

/// A field of a file of Linux's /proc in kB, as bytes.
fn proc_field(file: &Path, field: &str) -> Option<u64> {
    // Such a file says that it is empty, and each read makes it anew: one with room for all of it.
    let mut text = String::with_capacity(1 << 13);
    std::fs::File::open(file).ok()?.read_to_string(&mut text).ok()?;
    let line = text.lines().find(|l| l.starts_with(field))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kb| kb * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file system with these files.
    fn root(files: &[(&str, &str)]) -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = root.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        root
    }

    const TWO: &str = "31 23 0:26 / /sys/fs/cgroup rw,nosuid - cgroup2 cgroup2 rw,nsdelegate\n";

    #[test]
    fn the_tightest_group_of_version_2_counts() {
        let group = "sys/fs/cgroup/user.slice/job";
        let root = root(&[
            ("proc/self/cgroup", "0::/user.slice/job/step\n"),
            ("proc/self/mountinfo", TWO),
            ("sys/fs/cgroup/memory.stat", "anon 5\n"),
            ("sys/fs/cgroup/user.slice/memory.max", "900000000\n"),
            ("sys/fs/cgroup/user.slice/memory.current", "100000000\n"),
            (&format!("{group}/memory.max"), "500000000\n"),
            (&format!("{group}/memory.current"), "200000000\n"),
            (&format!("{group}/memory.stat"), "anon 100000000\ninactive_file 50000000\nactive_file 1\n"),
            (&format!("{group}/step/memory.max"), "max\n"),
            (&format!("{group}/step/memory.current"), "1\n"),
        ]);
        assert_eq!(control_groups(root.path()), Some(350_000_000));
        // A group that is over its limit leaves nothing.
        std::fs::write(root.path().join(group).join("memory.max"), "1000").unwrap();
        assert_eq!(control_groups(root.path()), Some(0));
    }

    #[test]
    fn version_1_is_found_by_its_controller_and_within_a_container() {
        let mounts = "35 31 0:32 /docker/1a2b /sys/fs/cgroup/memory rw - cgroup cgroup rw,memory\n\
                      36 31 0:33 / /sys/fs/cgroup/cpu rw - cgroup cgroup rw,cpu\n";
        let root = root(&[
            ("proc/self/cgroup", "4:cpu:/other\n3:hugetlb,memory:/docker/1a2b/inner\n0::/\n"),
            ("proc/self/mountinfo", mounts),
            ("sys/fs/cgroup/memory/memory.limit_in_bytes", "90000000"),
            ("sys/fs/cgroup/memory/memory.usage_in_bytes", "30000000"),
            ("sys/fs/cgroup/memory/memory.stat", "inactive_file 7\ntotal_inactive_file 10000000\n"),
            ("sys/fs/cgroup/memory/inner/memory.limit_in_bytes", "9223372036854771712"),
            ("sys/fs/cgroup/memory/inner/memory.usage_in_bytes", "1"),
        ]);
        assert_eq!(control_groups(root.path()), Some(70_000_000));
        // The path is that of the host, which the mount does not show.
        std::fs::write(root.path().join("proc/self/cgroup"), "3:memory:/elsewhere\n").unwrap();
        assert_eq!(control_groups(root.path()), Some(70_000_000));
        std::fs::remove_file(root.path().join("sys/fs/cgroup/memory/memory.limit_in_bytes")).unwrap();
        assert_eq!(control_groups(root.path()), None);
    }

    #[test]
    fn addresses_that_are_left_are_the_soft_limit_without_those_in_use() {
        let limits = |soft: &str| {
            format!(
                "Limit                     Soft Limit           Hard Limit           Units     \n\
                 Max stack size            8388608              unlimited            bytes     \n\
                 Max address space         {soft}            unlimited            bytes     \n"
            )
        };
        let root = root(&[
            ("proc/self/limits", &limits("1024000000")),
            ("proc/self/status", "Name:\tx\nVmPeak:\t  900000 kB\nVmSize:\t  500000 kB\n"),
        ]);
        assert_eq!(address_space(root.path()), Some(512_000_000));
        std::fs::write(root.path().join("proc/self/limits"), limits("unlimited")).unwrap();
        assert_eq!(address_space(root.path()), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn linux_tells() {
        let taken = std::hint::black_box(vec![1u8; 50_000_000]);
        let used = used_memory().unwrap();
        assert!(used > taken.len() as u64 && used <= peak_memory().unwrap());
        assert!(available_memory().unwrap() > 0);
    }
}
