!> The start of a step for contact: the laws in force, pairs removed or added, faces of removed elements.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A face of an element that a step removes touches nothing, whether it is on the slave or on the master. On the master no search
!! finds it (`facet_search`), on the slave it is not segmented, and a slave node without another face of its surface gives way.
module amontons_contact_step
  use amontons_kinds, only: DP
  use amontons_element_kinds, only: element_kind_type, element_kind, facet_kind_type, facet_kind
  use amontons_facets, only: facets_type
  use amontons_surfaces, only: surface_type, is_compliant, pair_interactions
  use amontons_steps, only: step_type
  use amontons_model, only: model_type, DIALECT_CALCULIX
  use amontons_state, only: slave_state_type
  use amontons_contact_pairs, only: contact_type
  implicit none
  private
  public :: begin_contact_step, find_faceless_slaves

contains

  !> Start of a step: the laws in force, the pairs removed or added, and the faces of removed elements.
  subroutine begin_contact_step(contact, model, step)
    type(contact_type), intent(inout) :: contact
    type(model_type), intent(in) :: model
    type(step_type), intent(in) :: step
    integer :: p
    contact%laws = pair_interactions(model%pairs, model%interactions)
    if (allocated(step%interactions)) contact%laws = pair_interactions(model%pairs, step%interactions)
    contact%is_removed = .false.
    if (allocated(step%is_removed)) contact%is_removed = step%is_removed
    contact%period = step%period
    contact%controls = step%controls%contact
    contact%interference = 0.0_DP
    contact%is_shrink_fit = .false.
    if (allocated(step%interference)) contact%interference = step%interference
    if (allocated(step%is_shrink_fit)) contact%is_shrink_fit = step%is_shrink_fit
    contact%is_ramped = model%dialect == DIALECT_CALCULIX .and. (model%pairs%is_mortar .or. is_compliant(contact%laws))
    if (allocated(contact%is_absent)) deallocate (contact%is_absent)
    if (allocated(step%is_inactive)) contact%is_absent = step%is_inactive
    do p = 1, size(model%pairs)
      call mark_absent_facets(contact%is_absent, contact%facets(p))
      call mark_absent_facets(contact%is_absent, contact%mortar(p)%slave)
    end do
  end subroutine begin_contact_step


  !> Marks the facets of removed elements; without any the marks go.
  pure subroutine mark_absent_facets(is_absent, facets)
    logical, allocatable, intent(in) :: is_absent(:)   !< (n_elements)
    type(facets_type), intent(inout) :: facets
    if (allocated(facets%is_absent)) deallocate (facets%is_absent)
    if (.not. allocated(is_absent) .or. allocated(facets%profile) .or. .not. allocated(facets%element)) return
    if (any(is_absent(facets%element))) facets%is_absent = is_absent(facets%element)
  end subroutine mark_absent_facets


  !> Whether a slave node has no face of its slave surface left, of a node-based one no element. Cost: linear, without removed
  !! elements none.
  pure function find_faceless_slaves(contact, model, slaves) result(is_faceless)
    type(contact_type), intent(in) :: contact
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slaves(:)
    logical :: is_faceless(size(slaves)), has_face(model%mesh%n_nodes)
    integer :: p, s, last
    is_faceless = .false.
    if (.not. allocated(contact%is_absent)) return
    last = 0
    do s = 1, size(slaves)                         ! those of a pair come one after the other
      p = slaves(s)%pair
      if (p /= last) has_face = nodes_with_faces(model, model%surfaces(model%pairs(p)%slave), contact%is_absent)
      last = p
      is_faceless(s) = .not. has_face(slaves(s)%node)
    end do
  end function find_faceless_slaves


  !> The nodes of the faces of a surface that are not removed, of a node-based one those of elements that are not.
  pure function nodes_with_faces(model, surface, is_absent) result(has_face)
    type(model_type), intent(in) :: model
    type(surface_type), intent(in) :: surface
    logical, intent(in) :: is_absent(:)            !< (n_elements)
    logical :: has_face(model%mesh%n_nodes)
    type(element_kind_type) :: kind
    type(facet_kind_type) :: shape
    integer :: e, f
    has_face = .false.
    associate (mesh => model%mesh)
      if (surface%is_node_based) then
        do e = 1, mesh%n_elements
          if (.not. is_absent(e)) has_face(mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1)) = .true.
        end do
        return
      end if
      do f = 1, size(surface%element)
        e = surface%element(f)
        if (is_absent(e)) cycle
        kind = element_kind(mesh%kind(e))
        shape = facet_kind(kind%face_kind(surface%face(f)))
        has_face(mesh%nodes(mesh%first(e) - 1 + kind%face_nodes(:shape%n_nodes, surface%face(f)))) = .true.
      end do
    end associate
  end function nodes_with_faces

end module amontons_contact_step
