!> Rotations that driven nodes of shells and beams take from the solids of a global model.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Shells and beams are solids in the results of a global model. A driven node of a shell is moved to the middle of the solid
!! where it is located, along the natural coordinate across the thickness: a node of a curved submodel need not lie on the flat
!! middle of a global element. There the gradient A of the displacements turns the fibre n and two directions across it; at a beam
!! it turns both directions of the cross-section. Small rotations: w = n x A n + 1/2 (e2 . A e1 - e1 . A e2) n. Finite ones: the
!! rotation of the frame of the moved directions. Where several solids lie over one another (layers) the place in its layer is kept.
module amontons_driven_directors
  use amontons_kinds, only: DP, PI
  use amontons_containers, only: list_groups, owners_of_entries
  use amontons_errors, only: error_type, set_error, EXIT_SETUP
  use amontons_element_kinds, only: N_SOLID_KINDS, KIND_C3D4, KIND_C3D10, KIND_CPS3, KIND_CPS6, MAX_ELEMENT_NODES
  use amontons_mesh_point_search, only: located_point_type
  use amontons_model, only: model_type
  use amontons_section_forces, only: rotation_vector
  use amontons_shape_functions, only: shape_functions, node_coordinates
  use amontons_structural_data, only: director_type, find_node_directors
  use amontons_tensor, only: cross_product, invert, IDENTITY
  use amontons_text, only: to_text
  implicit none
  private
  public :: driven_director_type, find_driven_directors, add_director_motion, continue_rotations

  real(DP), parameter :: MIN_COSINE = 0.85_DP        !< between the fibre of a shell and the thickness of the global solid [-]

  !> A fibre or cross-section in the global model.
  type :: driven_director_type
    integer :: n_outer = 0                           !< 2: of a shell, 4: of a beam, 0: the node has none
    real(DP) :: axes(3, 3) = 0                       !< shells: two tangents, then the normal; beams: both directions, the tangent
    real(DP) :: lever = 0                            !< of a shell with OFFSET: place of the node over the middle [length]
    real(DP) :: gradient(3, MAX_ELEMENT_NODES) = 0   !< of the shape functions of the global element [1/length]
  end type driven_director_type

contains

  !> The directors of the driven nodes; the places of nodes of shells move to the middle of the thickness. Errors: EXIT_SETUP.
  subroutine find_driven_directors(model, driven, kind, first, nodes, coordinates, located, directors, error)
    type(model_type), intent(in) :: model
    integer, intent(in) :: driven(:)                 !< nodes of the model
    integer, intent(in) :: kind(:), first(:), nodes(:)   !< elements of the global model
    real(DP), intent(in) :: coordinates(:, :)        !< (3, global nodes) [length]
    type(located_point_type), intent(inout) :: located(:)   !< (driven)
    type(driven_director_type), allocatable, intent(out) :: directors(:)   !< (driven)
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: first_at(:), at_node(:)   ! elements of each global node
    integer :: k, i, last
    logical :: is_ok
    allocate (directors(size(driven)))
    if (.not. allocated(model%structure)) return
    call list_groups(nodes, size(coordinates, 2), first_at, at_node)
    associate (owner => owners_of_entries(first))
      at_node = owner(at_node)
    end associate
    do k = 1, size(driven)
      call find_node_directors(model%structure, driven(k), i, last)
      if (last < i) cycle
      is_ok = .false.
      do i = i, last                                 ! one of the fibres at a fold belongs to the global solid
        associate (director => model%structure%directors(i))
          directors(k)%n_outer = director%n_outer
          directors(k)%axes = axes_of(director)
          directors(k)%lever = merge(director%offset(1) * director%thickness(1), 0.0_DP, director%n_outer == 2)
        end associate
        call place_in_element(kind(located(k)%element), first, nodes, first_at, at_node, coordinates, directors(k), located(k), &
          is_ok)
        if (is_ok) exit
      end do
      if (is_ok) cycle
      call set_error(error, EXIT_SETUP, 'The node ' // to_text(model%mesh%node_label(driven(k))) // ' of a shell is located ' // &
        'in a global element whose thickness is not along the normal of the shell: where the submodel has shells the global ' // &
        'model must have them, too. At an edge or fold name the other global elements by GLOBAL ELSET, or drive the ' // &
        'displacements of solids.')
      return
    end do
  end subroutine find_driven_directors


  !> Orthonormal axes: two tangents and the normal of a shell; the directions of a beam and its tangent.
  pure function axes_of(director) result(axes)
    type(director_type), intent(in) :: director
    real(DP) :: axes(3, 3), helper(3)
    if (director%n_outer == 4) then
      axes(:, :2) = director%axes
      axes(:, 3) = cross_product(axes(:, 1), axes(:, 2))
      return
    end if
    axes(:, 3) = director%axes(:, 1)
    helper = IDENTITY(:, minloc(abs(axes(:, 3)), dim=1))
    axes(:, 1) = cross_product(helper, axes(:, 3))
    axes(:, 1) = axes(:, 1) / norm2(axes(:, 1))
    axes(:, 2) = cross_product(axes(:, 3), axes(:, 1))
  end function axes_of


  !> Shape functions and their gradient at the place of a node; of a shell in the middle of its solid.
  subroutine place_in_element(kind, first, nodes, first_at, at_node, coordinates, director, located, is_ok)
    integer, intent(in) :: kind                      !< KIND_... of the global element
    integer, intent(in) :: first(:), nodes(:)
    integer, intent(in) :: first_at(:), at_node(:)   !< elements of each global node
    real(DP), intent(in) :: coordinates(:, :)
    type(driven_director_type), intent(inout) :: director
    type(located_point_type), intent(inout) :: located
    logical, intent(out) :: is_ok                    !< .false.: of a shell the last natural coordinate does not run along its
                                                     !! normal
    real(DP) :: N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES), J(3, 3), inverse(3, 3), det, xi(3)
    integer :: m, across, n_dims
    logical :: is_layer
    m = located%n_nodes
    xi = located%xi
    is_ok = .true.
    n_dims = merge(3, 2, kind <= N_SOLID_KINDS)
    associate (x => coordinates(:, located%nodes(:m)))
      call shape_functions(kind, xi, N, dN)
      J = matmul(x, transpose(dN(:, :m)))
      if (director%n_outer == 2) then
        across = n_dims                              ! of expanded shells
        is_ok = abs(dot_product(director%axes(:, 3), J(:, across))) >= MIN_COSINE * norm2(J(:, across))
        if (any(kind == [KIND_C3D4, KIND_C3D10, KIND_CPS3, KIND_CPS6])) is_ok = .false.
        if (.not. is_ok) return
        is_layer = is_covered(-1)
        if (.not. is_layer) is_layer = is_covered(1)
        if (.not. is_layer) xi(across) = 0
      end if
      call shape_functions(kind, xi, N, dN)
      J = matmul(x, transpose(dN(:, :m)))
      if (n_dims == 2) J(3, 3) = 1
      call invert(J, inverse, det)
      director%gradient(:, :m) = matmul(transpose(inverse), dN(:, :m))
      if (n_dims == 2) director%gradient(3, :m) = 0
      located%weights(:m) = N(:m)
    end associate

  contains

    !> Whether another element lies on the face of this one at an end of the coordinate across: layers.
    logical function is_covered(side)
      integer, intent(in) :: side                    !< 1 or -1
      real(DP) :: natural(3, MAX_ELEMENT_NODES)
      logical :: is_of_face(MAX_ELEMENT_NODES)
      integer :: a, i, node
      call node_coordinates(kind, natural)
      is_of_face = .false.
      is_of_face(:m) = nint(natural(across, :m)) == side
      is_covered = .false.
      node = located%nodes(findloc(is_of_face, .true., dim=1))
      do i = first_at(node), first_at(node + 1) - 1
        if (at_node(i) == located%element) cycle
        associate (own => nodes(first(at_node(i)):first(at_node(i) + 1) - 1))
          is_covered = .true.
          do a = 1, m
            if (is_of_face(a)) is_covered = is_covered .and. any(own == located%nodes(a))
            if (.not. is_covered) exit
          end do
        end associate
        if (is_covered) return
      end do
    end function is_covered

  end subroutine place_in_element


  !> Adds the rotation of a fibre or cross-section, and what it moves a node with OFFSET.
  pure subroutine add_director_motion(director, u, is_nlgeom, motion)
    type(driven_director_type), intent(in) :: director
    real(DP), intent(in) :: u(:, :)                  !< (3, nodes) of the global element [length]
    logical, intent(in) :: is_nlgeom                 !< rotations are finite
    real(DP), intent(inout) :: motion(6)             !< displacement, rotation vector
    real(DP) :: A(3, 3), change(3, 3)
    if (director%n_outer == 0) return
    A = matmul(u, transpose(director%gradient(:, :size(u, 2))))
    change = matmul(A, director%axes)                ! of the axes
    motion(:3) = motion(:3) + director%lever * change(:, 3)
    associate (e => director%axes)
      if (is_nlgeom) then
        motion(4:) = rotation_vector(matmul(frame_of(e + change, director%n_outer), transpose(frame_of(e, director%n_outer))))
      else
        motion(4:) = 0.5_DP * (dot_product(e(:, 2), change(:, 1)) - dot_product(e(:, 1), change(:, 2))) * e(:, 3)
        if (director%n_outer == 2) then
          motion(4:) = motion(4:) + cross_product(e(:, 3), change(:, 3))
        else
          motion(4:) = motion(4:) + dot_product(e(:, 3), change(:, 2)) * e(:, 1) - dot_product(e(:, 3), change(:, 1)) * e(:, 2)
        end if
      end if
    end associate
  end subroutine add_director_motion


  !> An orthonormal frame: along the bisector of the first two axes, and along the third (shells), or across both (beams).
  pure function frame_of(axes, n_outer) result(frame)
    real(DP), intent(in) :: axes(3, 3)
    integer, intent(in) :: n_outer                   !< 2 or 4
    real(DP) :: frame(3, 3), edge(3, 2)
    integer :: k
    edge = axes(:, :2)
    frame(:, 3) = axes(:, 3)
    if (n_outer == 4) frame(:, 3) = cross_product(edge(:, 1), edge(:, 2))
    frame(:, 3) = frame(:, 3) / norm2(frame(:, 3))
    do k = 1, 2
      edge(:, k) = edge(:, k) - dot_product(edge(:, k), frame(:, 3)) * frame(:, 3)
      edge(:, k) = edge(:, k) / norm2(edge(:, k))
    end do
    frame(:, 1) = edge(:, 1) + edge(:, 2)
    frame(:, 1) = frame(:, 1) / norm2(frame(:, 1))
    frame(:, 2) = cross_product(frame(:, 3), frame(:, 1))
  end function frame_of


  !> Takes of the rotation vectors that turn alike those nearest to the ones before: rotations beyond half a turn.
  pure subroutine continue_rotations(before, now)
    real(DP), intent(in) :: before(:, :)             !< (3, nodes) [rad]
    real(DP), intent(inout) :: now(:, :)             !< (3, nodes) [rad]
    real(DP) :: axis(3), angle
    integer :: k
    do k = 1, size(now, 2)
      angle = norm2(now(:, k))
      if (.not. angle > 0) cycle
      axis = now(:, k) / angle
      now(:, k) = axis * (angle + 2 * PI * anint((dot_product(axis, before(:, k)) - angle) / (2 * PI)))
    end do
  end subroutine continue_rotations

end module amontons_driven_directors
