//! Which elements of a shape are mapped, where its vertices are what is asked about.

/// The elements that the vertices of a mesh take their values from, each once: what [`super::dense_map`] maps.
#[derive(Clone, Debug, PartialEq)]
pub struct MapPoints {
    /// The elements, ascending: [`super::MapShape::points`].
    pub elements: Vec<u32>,
    /// The area of each one's vertices: [`super::MapShape::weights`].
    pub weights: Vec<f64>,
    /// The first vertex of each.
    first: Vec<u32>,
    /// The place of each vertex's element.
    place_of: Vec<Option<u32>>,
}

impl MapPoints {
    /// From the element of each vertex, none for those that are not mapped, and the vertices' areas.
    pub fn new(element_of_vertex: &[Option<u32>], areas: &[f64]) -> Self {
        let vertices = (0u32..).zip(element_of_vertex).zip(areas);
        let mut known: Vec<(u32, u32, f64)> =
            vertices.filter_map(|((vertex, element), &area)| Some(((*element)?, vertex, area))).collect();
        known.sort_unstable_by_key(|&(element, vertex, _)| (element, vertex));
        let (mut elements, mut weights, mut first) = (Vec::new(), Vec::new(), Vec::new());
        let mut place_of = vec![None; element_of_vertex.len()];
        for same in known.chunk_by(|a, b| a.0 == b.0) {
            same.iter().for_each(|&(_, vertex, _)| place_of[vertex as usize] = Some(elements.len() as u32));
            elements.push(same[0].0);
            first.push(same[0].1);
            weights.push(same.iter().map(|&(_, _, area)| area).sum());
        }
        Self { elements, weights, first, place_of }
    }

    /// For each vertex the first vertex of the element that its own is mapped to. `map` is what
    /// [`super::dense_map`] found from these points to those.
    pub fn vertices(&self, map: &[u32], to: &Self) -> Vec<Option<u32>> {
        let partner =
            |place: &Option<u32>| place.and_then(|p| to.first.get(*map.get(p as usize)? as usize).copied());
        self.place_of.iter().map(partner).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_of_one_element_go_together() {
        let points = MapPoints::new(&[Some(7), None, Some(3), Some(7)], &[1.0, 9.0, 2.0, 0.5]);
        assert_eq!((&points.elements[..], &points.weights[..]), (&[3, 7][..], &[2.0, 1.5][..]));
        let others = MapPoints::new(&[Some(0), Some(1), Some(1)], &[1.0; 3]);
        assert_eq!(points.vertices(&[1, 0], &others), [Some(0), None, Some(1), Some(0)]);
    }
}
