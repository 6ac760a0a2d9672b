!> Membership of exterior faces: which belong to a surface of the deck, and which a tie holds; the rules that name them.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_exterior_membership
  use amontons_surfaces, only: surface_type, general_contact_type
  use amontons_mpc_data, only: tie_type
  use amontons_mesh, only: find_connected_nodes
  use amontons_model, only: model_type, is_out, absent_elements
  use amontons_exterior_surface, only: exterior_type
  implicit none
  private
  public :: contact_rules, find_uncounted_elements, find_members, find_tie_lines, find_tied_faces

contains

  !> The elements that do not count for the exterior in a step: those removed in it. A whole body that another step adds counts:
  !! until then its faces touch nothing. Cost: linear, and only if elements are removed in that step.
  function find_uncounted_elements(model, step) result(is_out_of_job)
    type(model_type), intent(in) :: model
    integer, intent(in) :: step                    !< of the model, from 1; the pairs of general contact are those of step 1
    logical :: is_out_of_job(model%mesh%n_elements)
    logical, allocatable :: has_present(:)
    integer, allocatable :: body_of_node(:), body(:)
    integer :: e, i, n
    is_out_of_job = absent_elements(model, step)
    if (.not. any(is_out_of_job)) return
    call find_connected_nodes(model%mesh, body_of_node, n)
    allocate (has_present(0:n), source=.false.)
    body = body_of_node(model%mesh%nodes(model%mesh%first(:model%mesh%n_elements)))
    do e = 1, model%mesh%n_elements
      has_present(body(e)) = has_present(body(e)) .or. .not. is_out_of_job(e)
    end do
    do e = 1, model%mesh%n_elements
      if (is_out_of_job(e) .and. .not. has_present(body(e))) is_out_of_job(e) = all([(is_out(model, i, e), &
        i=1, size(model%steps))])
    end do
  end function find_uncounted_elements


  !> The exterior faces of a surface: those that it names, of a node-based one those with all nodes in it. An analytic one has none.
  pure function find_members(model, exterior, surface) result(is_in)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    type(surface_type), intent(in) :: surface
    logical :: is_in(exterior%n), is_member(6, model%mesh%n_elements), is_node(model%mesh%n_nodes)
    integer :: f
    is_in = .false.
    if (allocated(surface%profile)) return
    if (surface%is_node_based) then
      is_node = .false.
      is_node(surface%nodes) = .true.
      do f = 1, exterior%n
        is_in(f) = all(is_node(exterior%nodes(exterior%first(f):exterior%first(f + 1) - 1)))
      end do
    else
      is_member = .false.
      do f = 1, size(surface%element)
        is_member(surface%face(f), surface%element(f)) = .true.
      end do
      is_in = [(is_member(exterior%face(f), exterior%element(f)), f=1, exterior%n)]
    end if
  end function find_members


  !> The line of the tie or cyclic symmetry that holds each node as its slave; 0: none does. After `generate_ties`.
  pure function find_tie_lines(model) result(line)
    type(model_type), intent(in) :: model
    integer :: line(model%mesh%n_nodes), i
    logical, allocatable :: is_tie(:)              ! of each line up to the last tie
    line = 0
    if (.not. allocated(model%ties)) return
    if (size(model%ties) == 0) return
    allocate (is_tie(0:maxval(model%ties%line)), source=.false.)
    is_tie(model%ties%line) = .true.
    do i = 1, size(model%equations)
      associate (equation => model%equations(i))
        if (all(equation%card /= [character(24) :: 'TIE', 'CYCLIC SYMMETRY', 'SHELL TO SOLID COUPLING'])) cycle
        if (equation%line > ubound(is_tie, 1)) cycle
        if (is_tie(equation%line)) line(equation%node(1)) = equation%line
      end associate
    end do
  end function find_tie_lines


  !> The faces that a tie holds: those of its slave surface with a tied node. Nodes beyond the position tolerance or beside the
  !! master are not tied, and their faces are free.
  pure function find_tied_faces(model, exterior, tie, tie_line) result(is_tied)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    type(tie_type), intent(in) :: tie
    integer, intent(in) :: tie_line(:)             !< (n_nodes) of `find_tie_lines`
    logical :: is_tied(exterior%n)
    integer :: f
    is_tied = find_members(model, exterior, model%surfaces(tie%slave))
    do f = 1, exterior%n
      if (is_tied(f)) is_tied(f) = any(tie_line(exterior%nodes(exterior%first(f):exterior%first(f + 1) - 1)) == tie%line)
    end do
  end function find_tied_faces


  !> The rules of general contact; without it, rules that include nothing.
  pure function contact_rules(model) result(rules)
    type(model_type), intent(in) :: model
    type(general_contact_type) :: rules
    if (allocated(model%general_contact)) then
      rules = model%general_contact
    else
      allocate (rules%included(2, 0), rules%excluded(2, 0), rules%assigned(3, 0), rules%roles(2, 0), rules%initialized(3, 0))
    end if
  end function contact_rules

end module amontons_exterior_membership
