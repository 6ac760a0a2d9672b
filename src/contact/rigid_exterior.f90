!> Rigid bodies on the exterior: which nodes belong to one, and which of them supports drive.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_rigid_exterior
  use amontons_text, only: to_text
  use amontons_element_kinds, only: KIND_R2D2, KIND_RAX2
  use amontons_model, only: model_type
  use amontons_mpc_data, only: MPC_RIGID_BODY
  implicit none
  private
  public :: rigid_bodies_type, collect_rigid_bodies, free_unknowns, is_pair_driven, is_one_body, unpaired_edges_warning

  !> The rigid body of each node.
  type :: rigid_bodies_type
    integer, allocatable :: reference(:)           !< (n_nodes) its reference node; 0: the node is of none
    logical, allocatable :: is_whole(:)            !< (n_nodes) no motion of its own is left, as by a coupling of some directions
    logical, allocatable :: is_driven(:)           !< (n_nodes) and supports prescribe the motion of the reference node in each step
  end type rigid_bodies_type

contains

  !> The rigid bodies of the nodes, and those that supports drive in each step.
  subroutine collect_rigid_bodies(model, bodies)
    type(model_type), intent(in) :: model
    type(rigid_bodies_type), intent(out) :: bodies
    logical, allocatable :: is_free(:, :)
    integer :: i, k, n_dofs, first_rotation
    allocate (bodies%reference(model%mesh%n_nodes), source=0)
    allocate (bodies%is_driven(model%mesh%n_nodes), bodies%is_whole(model%mesh%n_nodes), source=.false.)
    if (.not. allocated(model%nonlinear_mpcs)) return
    n_dofs = merge(2, 3, all(model%mesh%is_unstiffened(3, :) .or. .not. model%mesh%has_elements))   ! plane models: 2
    first_rotation = merge(3, 1, n_dofs == 2)
    bodies%is_driven = .true.
    do k = 1, size(model%steps)
      is_free = free_unknowns(model, k)
      do i = 1, size(model%nonlinear_mpcs)
        associate (body => model%nonlinear_mpcs(i))
          if (body%kind /= MPC_RIGID_BODY) cycle
          bodies%reference(body%node) = body%reference
          bodies%is_whole(body%node) = all(body%is_bound(:n_dofs)) .and. body%expansion == 0
          bodies%is_driven(body%node) = bodies%is_driven(body%node) .and. .not. any(is_free(:n_dofs, body%reference))
          if (body%rotation > 0) bodies%is_driven(body%node) = bodies%is_driven(body%node) .and. &
            .not. any(is_free(first_rotation:, body%rotation))
        end associate
      end do
    end do
    bodies%is_driven = bodies%is_driven .and. bodies%is_whole
  end subroutine collect_rigid_bodies


  !> The displacements that no support prescribes in a step.
  pure function free_unknowns(model, step) result(is_free)
    type(model_type), intent(in) :: model
    integer, intent(in) :: step
    logical :: is_free(3, model%mesh%n_nodes)
    integer :: i
    is_free = .true.
    if (step > size(model%steps)) return
    do i = 1, size(model%steps(step)%prescribed)
      is_free(model%steps(step)%prescribed(i)%dof, model%steps(step)%prescribed(i)%node) = .false.
    end do
  end function free_unknowns


  !> Whether two nodes cannot move relative to each other but as prescribed: they belong to one rigid body or to two driven ones.
  pure logical function is_pair_driven(bodies, nodes)
    type(rigid_bodies_type), intent(in) :: bodies
    integer, intent(in) :: nodes(2)
    is_pair_driven = all(bodies%is_driven(nodes)) .or. is_one_body(bodies, nodes)
  end function is_pair_driven


  !> Whether two nodes belong to one rigid body.
  pure logical function is_one_body(bodies, nodes)
    type(rigid_bodies_type), intent(in) :: bodies
    integer, intent(in) :: nodes(2)
    is_one_body = all(bodies%is_whole(nodes)) .and. bodies%reference(nodes(1)) == bodies%reference(nodes(2))
  end function is_one_body


  !> The warning of general contact about rigid edges of no pair, which bound no body and are not on the exterior; '': none.
  function unpaired_edges_warning(model) result(warning)
    type(model_type), intent(in) :: model
    character(:), allocatable :: warning
    logical :: is_found(model%mesh%n_elements)
    integer :: e, p
    is_found = .false.
    do p = 1, size(model%pairs)
      call mark_elements(model%pairs(p)%slave)
      call mark_elements(model%pairs(p)%master)
    end do
    warning = ''
    e = findloc((model%mesh%kind == KIND_R2D2 .or. model%mesh%kind == KIND_RAX2) .and. .not. is_found, .true., dim=1)
    if (e == 0) return
    warning = 'General contact does not find rigid edges (R2D2, RAX2), as element ' // to_text(model%mesh%element_label(e)) // &
      ': other bodies pass through them. If they can touch, name their side (SPOS or SNEG) in a *CONTACT PAIR.'

  contains

    !> The elements of a surface.
    subroutine mark_elements(surface)
      integer, intent(in) :: surface               !< index
      if (allocated(model%surfaces(surface)%element)) is_found(model%surfaces(surface)%element) = .true.
    end subroutine mark_elements

  end function unpaired_edges_warning

end module amontons_rigid_exterior
