!> Mechanical: the strain without its thermal part, at the integration points.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_mechanical
  use amontons_kinds, only: DP
  use amontons_element, only: find_temperature_weights
  use amontons_material_point, only: thermal_strain_of
  use amontons_mesh, only: element_nodes
  use amontons_model, only: model_type
  use amontons_state, only: fields_type
  use amontons_tensor, only: IDENTITY
  use amontons_topology, only: MAX_NODES, MAX_POINTS
  implicit none
  private
  public :: mechanical_strain

contains

  !> Total strain less thermal strain, elastic and inelastic together (ME of EL PRINT).
  pure function mechanical_strain(model, fields) result(strain)
    type(model_type), intent(in) :: model
    type(fields_type), intent(in) :: fields        !< committed
    real(DP) :: strain(6, model%mesh%n_points)     !< tensor components, xx yy zz xy yz xz [-]
    real(DP) :: weight(MAX_NODES, MAX_POINTS), frame(3, 3), now, start
    logical :: is_nlgeom
    integer :: e, p, i, n, nodes(MAX_NODES)
    is_nlgeom = model%steps(max(1, fields%step))%is_nlgeom
    strain = fields%strain
    do e = 1, model%mesh%n_elements
      associate (m => max(1, model%mesh%material(e)))
        if (.not. allocated(model%materials(m)%expansion%value)) cycle
        call element_nodes(model%mesh, e, n, nodes)
        call find_temperature_weights(model%mesh%kind(e), weight)
        do p = model%mesh%point_first(e), model%mesh%point_first(e + 1) - 1
          i = p - model%mesh%point_first(e) + 1
          now = dot_product(weight(:n, i), fields%temperature(nodes(:n)))
          start = 0
          if (allocated(model%initial_temperature)) start = dot_product(weight(:n, i), model%initial_temperature(nodes(:n)))
          frame = IDENTITY
          if (allocated(fields%frame)) frame = fields%frame(:, :, p)
          strain(:, p) = strain(:, p) - thermal_strain_of(model%materials(m), now, start, frame, is_nlgeom)
        end do
      end associate
    end do
  end function mechanical_strain

end module amontons_mechanical
