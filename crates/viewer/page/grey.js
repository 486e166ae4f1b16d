// Slices of the grey volume that the regions were found in, beside the shape: a pixel for each voxel.

const greyShape = data.shapes.find((shape) => shape.grey);
const grey = { axis: 2, at: 0.5 };

// The two axes of the picture, right and up, and the number of the slice.
function greyPlane() {
  const { dims } = greyShape.grey;
  const [u, v] = [[1, 2], [0, 2], [0, 1]][grey.axis];
  return { dims, u, v, layer: Math.round(grey.at * (dims[grey.axis] - 1)) };
}

// The voxel of the shape at a place of the grey volume; -1 for none. Of coarser grey values, the first voxel in each.
function voxelOfGrey(place) {
  const { step } = greyShape.grey;
  const [nx, ny] = greyShape.grid.dims;
  const [i, j, k] = place.map((x) => x * step);
  return voxelsByPlace(greyShape.grid)[(k * ny + j) * nx + i];
}

// Grey values, and over them the regions in their colours; what is chosen more strongly, the others less.
function drawGrey() {
  if (!greyShape) return;
  const { dims, u, v, layer } = greyPlane();
  const sheet = byId("grey");
  [sheet.width, sheet.height] = [dims[u], dims[v]];
  const { spacing } = greyShape.grid;
  sheet.style.aspectRatio = `${dims[u] * spacing[u]} / ${dims[v] * spacing[v]}`;
  const s = data.shapes.indexOf(greyShape);
  const chosen = idsOf(state.chosen, s).map((id) => membership(greyShape, "regions", id, "voxel"));
  const hidden = new Set(state.hidden.regions.map(({ id }) => id));
  const pixels = new ImageData(dims[u], dims[v]);
  const place = [0, 0, 0];
  place[grey.axis] = layer;
  for (let row = 0; row < dims[v]; row++) {
    for (let column = 0; column < dims[u]; column++) {
      [place[u], place[v]] = [column, dims[v] - 1 - row];
      const value = greyShape.grey.values[(place[2] * dims[1] + place[1]) * dims[0] + place[0]];
      const voxel = voxelOfGrey(place);
      const label = voxel < 0 ? -1 : greyShape.labels.regions.voxel[voxel];
      let colour = [value, value, value];
      if (label >= 0 && !hidden.has(label)) {
        const lit = chosen.length ? (chosen.some((inside) => inside(voxel)) ? 0.75 : 0.15) : 0.4;
        colour = mix(colour, greyShape.regions[label].colour, lit);
      }
      pixels.data.set([...colour, 255], 4 * (row * dims[u] + column));
    }
  }
  sheet.getContext("2d").putImageData(pixels, 0, 0);
  byId("grey-text").textContent = `${layer * greyShape.grey.step + 1} of ${greyShape.grid.dims[grey.axis]}`;
}

if (greyShape) {
  byId("grey-part").hidden = false;
  document.querySelectorAll("input[name=grey]").forEach((input) =>
    input.addEventListener("change", () => {
      grey.axis = Number(input.value);
      drawGrey();
    }));
  byId("grey-at").addEventListener("input", (event) => {
    grey.at = event.target.value / 1000;
    drawGrey();
  });
  byId("grey").addEventListener("click", (event) => {
    const { dims, u, v, layer } = greyPlane();
    const box = byId("grey").getBoundingClientRect();
    const place = [0, 0, 0];
    place[grey.axis] = layer;
    place[u] = Math.floor(((event.clientX - box.left) / box.width) * dims[u]);
    place[v] = dims[v] - 1 - Math.floor(((event.clientY - box.top) / box.height) * dims[v]);
    const voxel = voxelOfGrey(place);
    const label = voxel < 0 ? -1 : greyShape.labels.regions.voxel[voxel];
    choose(0, label < 0 ? null : label, "regions");
  });
}
