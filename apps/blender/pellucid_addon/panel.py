"""The panel in the sidebar of the 3D view, tab Pellucid."""

import bpy


class PELLUCID_PT_panel(bpy.types.Panel):
    bl_label, bl_idname = "Pellucid", "PELLUCID_PT_panel"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "Pellucid"

    def draw(self, context):
        layout, settings = self.layout, context.scene.pellucid
        layout.use_property_split = True
        row = layout.row()
        row.scale_y = 1.5
        row.enabled = not settings.status
        row.operator("pellucid.render", text=settings.status or "Render", icon="RENDER_STILL")
        column = layout.column()
        for name in ("samples", "exposure", "shadow_size", "unit"):
            column.prop(settings, name)


class PELLUCID_PT_materials(bpy.types.Panel):
    """Those of the selected objects, or all that are in use."""

    bl_label, bl_idname, bl_parent_id = "Materials", "PELLUCID_PT_materials", "PELLUCID_PT_panel"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "Pellucid"

    def draw(self, context):
        things = [t for t in context.selected_objects
                  if t.type == "MESH"] or [t for t in context.scene.objects if t.type == "MESH"]
        materials = sorted({slot.material for t in things for slot in t.material_slots if slot.material},
                           key=lambda m: m.name)
        for material in materials:
            row = self.layout.row(align=True)
            row.label(text=material.name, icon_value=material.preview.icon_id if material.preview else 0)
            row.prop(material, "pellucid", text="")
        if not materials:
            self.layout.label(text="No materials: everything is skin")


CLASSES = (PELLUCID_PT_panel, PELLUCID_PT_materials)


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)


def unregister():
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
