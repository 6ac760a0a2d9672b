!> Connected bodies of the mesh with bounding boxes, volumes and masses, and text helpers for the messages of the model check.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_model_check_bodies
  use amontons_kinds, only: DP
  use amontons_tensor, only: cross_product
  use amontons_text, only: to_text, plural
  use amontons_element, only: evaluate_element_volume
  use amontons_model, only: model_type, is_out, absent_elements, material_in_step
  use amontons_element_kinds, only: KIND_MASS
  use amontons_errors, only: diagnostic_list_type
  use amontons_loads, only: equation_type
  use amontons_mesh, only: mesh_type, find_connected_nodes, wall_ratios
  implicit none
  private
  public :: body_type, bodies_type, find_bodies, weigh_bodies, mean_element_sizes, body_name
  public :: line_of_nodes
  public :: report_error, report_warning, label_list, step_list, join_item, counted_noun

  !> Elements connected by their nodes, or one node without elements that occurs in an equation.
  type :: body_type
    integer :: n_elements = 0                      !< 0: a node without elements
    integer :: element = 0                         !< its first element
    integer :: node = 0                            !< its first node
    real(DP) :: low(3) = huge(1.0_DP)              !< bounding box [length]
    real(DP) :: high(3) = -huge(1.0_DP)
    real(DP) :: centre(3) = 0                      !< of the box [length]
    real(DP) :: size = 1                           !< half the diagonal of the box [length]
    real(DP) :: volume = 0                         !< after weigh_bodies [length^3]
    real(DP) :: mass = 0                           !< of the elements with a density, after weigh_bodies [mass]
    character(:), allocatable :: set               !< name of an element set that is exactly this body; '': no such set
  end type body_type

  !> All bodies, in the order of their first elements.
  type :: bodies_type
    integer :: n = 0
    integer, allocatable :: of_node(:)             !< (n_nodes) 0: none
    integer, allocatable :: of_element(:)          !< (n_elements)
    type(body_type), allocatable :: list(:)        !< (n)
    type(equation_type), allocatable :: equations(:)   !< those between their nodes
  end type bodies_type

  integer, parameter :: MAX_LABELS_SHOWN = 10      !< labels of a list; of the others only the number appears

contains

  !> Finds the bodies and their boxes. Cost: linear.
  subroutine find_bodies(model, equations, step, bodies)
    type(model_type), intent(in) :: model
    type(equation_type), intent(in) :: equations(:)   !< those of the model, or with its nonlinear MPCs linearized
    integer, intent(in) :: step                    !< whose elements count: index into model%steps
    type(bodies_type), intent(out) :: bodies
    integer :: e, i, k
    associate (mesh => model%mesh)
      call find_connected_nodes(mesh, bodies%of_node, bodies%n, [(is_out(model, step, e), e=1, mesh%n_elements)])
      bodies%equations = equations
      do i = 1, size(equations)
        do k = 1, size(equations(i)%node)
          call number_body(bodies, equations(i)%node(k))
        end do
      end do
      bodies%of_element = bodies%of_node(mesh%nodes(mesh%first(:mesh%n_elements)))
      where (absent_elements(model, step)) bodies%of_element = 0
    end associate
    call measure_bodies(model%mesh, bodies)
    call name_bodies(model, bodies)
  end subroutine find_bodies


  !> Numbers a new body for a node without one.
  subroutine number_body(bodies, node)
    type(bodies_type), intent(inout) :: bodies
    integer, intent(in) :: node
    if (bodies%of_node(node) > 0) return
    bodies%n = bodies%n + 1
    bodies%of_node(node) = bodies%n
  end subroutine number_body


  !> Computes the boxes and counts the elements.
  subroutine measure_bodies(mesh, bodies)
    type(mesh_type), intent(in) :: mesh
    type(bodies_type), intent(inout) :: bodies
    integer :: i, e
    allocate (bodies%list(bodies%n))
    do i = 1, mesh%n_nodes
      if (bodies%of_node(i) == 0) cycle
      associate (body => bodies%list(bodies%of_node(i)))
        if (body%node == 0) body%node = i
        body%low = min(body%low, mesh%coordinates(:, i))
        body%high = max(body%high, mesh%coordinates(:, i))
      end associate
    end do
    do e = 1, mesh%n_elements
      if (bodies%of_element(e) == 0) cycle
      associate (body => bodies%list(bodies%of_element(e)))
        if (body%n_elements == 0) body%element = e
        body%n_elements = body%n_elements + 1
      end associate
    end do
    do i = 1, bodies%n
      associate (body => bodies%list(i))
        body%centre = 0.5_DP * (body%low + body%high)
        if (body%n_elements > 0) body%size = max(0.5_DP * norm2(body%high - body%low), tiny(1.0_DP))
      end associate
    end do
  end subroutine measure_bodies


  !> Computes the volumes and masses of the bodies.
  subroutine weigh_bodies(model, step, bodies)
    type(model_type), intent(in) :: model
    integer, intent(in) :: step                    !< whose materials count: index into model%steps
    type(bodies_type), intent(inout) :: bodies     !< as found in this step
    real(DP) :: volume
    integer :: e, m
    associate (mesh => model%mesh)
      do e = 1, mesh%n_elements
        if (bodies%of_element(e) == 0) cycle
        associate (body => bodies%list(bodies%of_element(e)))
          volume = volume_of(mesh, e)
          body%volume = body%volume + volume
          if (mesh%kind(e) == KIND_MASS) body%mass = body%mass + mesh%section_value(e)
          m = material_in_step(model, step, e)
          if (m > 0) body%mass = body%mass + model%materials(m)%density * volume
        end associate
      end do
    end associate
  end subroutine weigh_bodies


  !> The mean size of the elements of each body: the edge of a cube of their mean volume [length].
  pure function mean_element_sizes(mesh, bodies) result(sizes)
    type(mesh_type), intent(in) :: mesh
    type(bodies_type), intent(in) :: bodies
    real(DP) :: sizes(bodies%n)
    integer :: e
    sizes = 0
    do e = 1, mesh%n_elements
      if (bodies%of_element(e) > 0) sizes(bodies%of_element(e)) = sizes(bodies%of_element(e)) + volume_of(mesh, e)
    end do
    sizes = (sizes / real(max(1, bodies%list%n_elements), DP))**(1.0_DP / 3.0_DP)
  end function mean_element_sizes


  !> The volume of an element [length^3].
  pure real(DP) function volume_of(mesh, e) result(volume)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e                       !< element
    integer :: status
    associate (nodes => mesh%nodes(mesh%first(e):mesh%first(e + 1) - 1))
      call evaluate_element_volume(mesh%kind(e), mesh%coordinates(:, nodes), mesh%section_value(e), volume, status, &
        wall_ratios(mesh, e))
    end associate
  end function volume_of


  !> Names each body after the first element set of the deck that is exactly this body, if any.
  subroutine name_bodies(model, bodies)
    type(model_type), intent(in) :: model
    type(bodies_type), intent(inout) :: bodies
    integer :: i, b
    do b = 1, bodies%n
      bodies%list(b)%set = ''
    end do
    if (.not. allocated(model%mesh%element_sets)) return
    do i = size(model%mesh%element_sets), 1, -1
      associate (set => model%mesh%element_sets(i))
        if (size(set%members) == 0) cycle
        b = bodies%of_element(set%members(1))
        if (b == 0) cycle
        if (size(set%members) /= bodies%list(b)%n_elements) cycle
        if (all(bodies%of_element(set%members) == b)) bodies%list(b)%set = set%name
      end associate
    end do
  end subroutine name_bodies


  !> 'body of element 17 (set BLOCK, 240 elements)', 'node 5 (without elements)'.
  function body_name(model, body) result(text)
    type(model_type), intent(in) :: model
    type(body_type), intent(in) :: body
    character(:), allocatable :: text
    if (body%n_elements == 0) then
      text = 'node ' // to_text(model%mesh%node_label(body%node)) // ' (without elements)'
    else
      text = 'body of element ' // to_text(model%mesh%element_label(body%element)) // ' ('
      if (len(body%set) > 0) text = text // 'set ' // body%set // ', '
      text = text // plural(body%n_elements, 'element') // ')'
    end if
  end function body_name


  !> Puts an error into the report.
  subroutine report_error(report, text)
    type(diagnostic_list_type), intent(inout) :: report
    character(*), intent(in) :: text           !< whole sentences: what is wrong, and the remedy
    call report%add('', 0, '', text)
  end subroutine report_error


  !> Puts a warning or a note into the report.
  subroutine report_warning(report, text)
    type(diagnostic_list_type), intent(inout) :: report
    character(*), intent(in) :: text           !< whole sentences
    call report%add('', 0, '', text, is_warning=.true.)
  end subroutine report_warning


  !> '3, 5 and 8'; of more than ten labels '3, 5, ..., 12 and 7 more'.
  pure function label_list(labels) result(text)
    integer, intent(in) :: labels(:)           !< of nodes or elements
    character(:), allocatable :: text
    integer :: i, n_shown
    n_shown = min(size(labels), MAX_LABELS_SHOWN)
    text = ''
    do i = 1, n_shown
      text = join_item(text, to_text(labels(i)), i == size(labels))
    end do
    if (n_shown < size(labels)) text = join_item(text, to_text(size(labels) - n_shown) // ' more', .true.)
  end function label_list


  !> 'step 2', 'steps 1 and 3', 'steps 2 to 5'.
  pure function step_list(steps) result(text)
    integer, intent(in) :: steps(:)            !< numbers, ascending, at least one
    character(:), allocatable :: text
    integer :: n
    n = size(steps)
    if (n == 1) then
      text = 'step ' // to_text(steps(1))
    else if (n > 2 .and. steps(n) - steps(1) == n - 1) then
      text = 'steps ' // to_text(steps(1)) // ' to ' // to_text(steps(n))
    else
      text = 'steps ' // label_list(steps)
    end if
  end function step_list


  !> The text with one more item of an enumeration.
  pure function join_item(text, item, is_last) result(longer)
    character(*), intent(in) :: text           !< the items so far, empty at first
    character(*), intent(in) :: item
    logical, intent(in) :: is_last             !< 'and' precedes it
    character(:), allocatable :: longer
    if (text == '') then
      longer = item
    else if (is_last) then
      longer = text // ' and ' // item
    else
      longer = text // ', ' // item
    end if
  end function join_item


  !> 'node 7 is', 'nodes 7 and 9 are': the subject of a sentence with its verb.
  pure function counted_noun(noun, labels, singular, plural) result(text)
    character(*), intent(in) :: noun           !< 'node', 'element'
    integer, intent(in) :: labels(:)
    character(*), intent(in) :: singular       !< verb after one
    character(*), intent(in) :: plural         !< verb after several
    character(:), allocatable :: text
    if (size(labels) == 1) then
      text = noun // ' ' // label_list(labels) // ' ' // singular
    else
      text = to_text(size(labels)) // ' ' // noun // 's (' // label_list(labels) // ') ' // plural
    end if
  end function counted_noun


  !> The direction of the line on which points lie: a unit vector; 0: they lie on none, or all at the first.
  pure function line_of_nodes(points, tolerance) result(axis)
    real(DP), intent(in) :: points(:, :)           !< (3, n) [length]
    real(DP), intent(in) :: tolerance              !< distance from the line over the largest distance from the first [-]
    real(DP) :: axis(3), longest
    integer :: i
    longest = 0
    axis = 0
    do i = 2, size(points, 2)
      if (.not. norm2(points(:, i) - points(:, 1)) > longest) cycle
      longest = norm2(points(:, i) - points(:, 1))
      axis = (points(:, i) - points(:, 1)) / longest
    end do
    do i = 2, size(points, 2)
      if (norm2(cross_product(axis, points(:, i) - points(:, 1))) > tolerance * longest) axis = 0
    end do
  end function line_of_nodes

end module amontons_model_check_bodies
