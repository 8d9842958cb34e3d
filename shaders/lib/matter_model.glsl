// The model that stands in the matter, around a position. Requires `args` with setting and bodyPoints; the nodes of the
// model follow the points of a ball in bodyPoints.
#ifndef PALPATE_LIB_MATTER_MODEL_GLSL
#define PALPATE_LIB_MATTER_MODEL_GLSL

bool hasModel() { return SETTING.model.nodes.x > 0; }

ModelField modelField() {
  return ModelField(SETTING.model.corner, SETTING.model.nodesPerMetre, SETTING.model.nodes, SETTING.model.nearest);
}

ModelAt modelAbout(vec3 place) {
  if (!hasModel()) return noModel();
  const ModelField field = modelField();
  const ModelCell cell = modelCell(field, place);
  if (cell.isOutside) return noModel();
  const uint row = SETTING.bodyPoints + modelNode(field, cell.node), deep = uint(field.nodes.x * field.nodes.y);
  return modelAt(field, cell.part, args.bodyPoints.at[row], args.bodyPoints.at[row + field.nodes.x],
                 args.bodyPoints.at[row + deep], args.bodyPoints.at[row + deep + field.nodes.x]);
}

#endif
